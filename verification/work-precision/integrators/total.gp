x_format = "10^{%L}"; x_label = "processor time (s)"; y_label = "total error (%)"
caption = "bias and statistics together, for each run time at the best of the steps; dotted: 1 % and 0.1 %"
shown = "1 2 3 4 5 6 7 8 9 10"
set xrange [0.01:1e5]; set yrange [0.01:30]
line(o, n) = sprintf("data index 'total:%s:%s:' using 1:(100*$2) with lines lw 1.6 lc rgb '%s', ", names[n], observables[o], colours[n])
draw(o) = (s = "", sum [i = 1:words(shown)] (s = s.line(o, word(shown, i) + 0), 0), s."1 dt 3 lc rgb grey, 0.1 dt 3 lc rgb grey")
load script_directory."/panels.gp"
