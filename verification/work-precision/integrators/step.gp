x_format = "%g"; x_label = "time step"; y_label = "deviation (%)"
caption = "deviation from step zero; symbols: clear of twice their error; lines: what the fitted law allows; dotted: first and second order"
shown = "1 2 3 4 5 6 7 8 9 10"
set xrange [0.004:0.25]; set yrange [0.01:100]
line(o, n) = sprintf("data index 'error:%s:%s:' using 1:(100*$5) with lines lw 1.4 lc rgb '%s', ", names[n], observables[o], colours[n])
point(o, n) = sprintf("data index 'error:%s:%s:' using 1:(abs($2) > 2*$3 ? 100*abs($2) : NaN):(100*$3) with yerrorbars pt %d ps 0.9 lc rgb '%s', ", \
    names[n], observables[o], 4 + n, colours[n])
guides = "100*x dt 3 lc rgb grey, 1000*x**2 dt 3 lc rgb grey"
draw(o) = (s = "", sum [i = 1:words(shown)] (s = s.line(o, word(shown, i) + 0).point(o, word(shown, i) + 0), 0), s.guides)
load script_directory."/panels.gp"
