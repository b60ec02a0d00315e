x_format = "10^{%L}"; x_label = "processor time of the run (s)"; y_label = "deviation (%)"
caption = "the same simulated time for every run; symbols: clear of twice their error; lines: what the fitted law allows"
set xrange [0.2:40]; set yrange [0.01:100]
line(o, n) = sprintf("data index 'error:%s:%s:' using 4:(100*$5) with lines lw 1.4 lc rgb '%s', ", names[n], observables[o], colours[n])
point(o, n) = sprintf("data index 'error:%s:%s:' using 4:(abs($2) > 2*$3 ? 100*abs($2) : NaN):(100*$3) with yerrorbars pt %d ps 0.9 lc rgb '%s', ", \
    names[n], observables[o], 4 + n, colours[n])
draw(o) = (s = "", sum [n = 1:|names|] (s = s.line(o, n).point(o, n), 0), s."1 dt 3 lc rgb grey, 0.1 dt 3 lc rgb grey")
load script_directory."/panels.gp"
