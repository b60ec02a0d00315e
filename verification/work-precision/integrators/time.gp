x_format = "%g"; x_label = "processor time of the run (s)"; y_label = "deviation (%)"
caption = "the same simulated time for every run; symbols: clear of twice their error; lines: what the fitted law allows; six of the ten"
# left out: Euler, old, which is far off; GW 0.5, Peters and Lowe, which go along with Euler, new and with S1
shown = "2 4 5 6 7 10"
set xtics (0.3, 1, 3, 10, 30)
set xrange [*:*] noextend; set yrange [0.01:20]
line(o, n) = sprintf("data index 'error:%s:%s:' using 4:(100*$5) with lines lw 1.4 lc rgb '%s', ", names[n], observables[o], colours[n])
point(o, n) = sprintf("data index 'error:%s:%s:' using 4:(abs($2) > 2*$3 ? 100*abs($2) : NaN):(100*$3) with yerrorbars pt %d ps 0.9 lc rgb '%s', ", \
    names[n], observables[o], 4 + n, colours[n])
draw(o) = (s = "", sum [i = 1:words(shown)] (s = s.line(o, word(shown, i) + 0).point(o, word(shown, i) + 0), 0), s."1 dt 3 lc rgb grey, 0.1 dt 3 lc rgb grey")
load script_directory."/panels.gp"
