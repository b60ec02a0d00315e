# 1/T against the step: lines are eq. 22, filled points the dynamics, open ones positions redrawn every step.
names = "0.1 0.2 0.5 1.0"
array colour[4] = [green, blue, red, purple]
q = "kinetic_temperature"
part(n, kind) = "n=".word(names, n).kind.":".q

@upper
set xrange [0:0.75]; set yrange [0:2.2]
set ylabel "inverse temperature 1/k_BT" offset 0.5,0
set key top right
plot for [n=1:4] lines index part(n, "") using 1:(1/$2) with lines lw 2 lc rgb colour[n] notitle, \
     for [n=1:4] lines index part(n, " edge") using 1:(1/$2) with lines lw 2 lc rgb colour[n] notitle, \
     for [n=1:4] lines index part(n, " chaos") using 1:(1/$2) with lines lw 2 lc rgb colour[n] notitle, \
     for [n=1:4] data index part(n, "") using 1:(1/$2):($3/$2**2) with yerrorbars pt 7 ps 1 lw 1.5 lc rgb colour[n] title "n = ".word(names, n), \
     for [n=1:4] data index part(n, " edge") using 1:(1/$2):($3/$2**2) with yerrorbars pt 7 ps 1 lw 1.5 lc rgb colour[n] notitle, \
     for [n=1:4] data index part(n, " chaos") using 1:(1/$2):($3/$2**2) with yerrorbars pt 6 ps 1.4 lw 1.5 lc rgb colour[n] notitle, \
     for [e=1:2] data index "n=0.2 old momentum".word("' ' edge", e)[2:].":".q using 1:(1/$2) with points pt 2 ps 1 lw 1.5 lc rgb blue notitle, \
     NaN with points pt 7 lc rgb black title "dynamics", NaN with points pt 6 ps 1.4 lc rgb black title "positions redrawn", \
     NaN with points pt 2 lc rgb blue title "n = 0.2, old momentum"
@lower
set xlabel "time step {/Symbol D}t" offset 0,0.4
set yrange [-25:25]
unset key
plot 0 with lines lw 2 lc rgb grey, \
     for [n=1:4] data index part(n, "") using 1:(100*$5):(100*$6) with yerrorbars pt 7 ps 1 lw 1.5 lc rgb colour[n], \
     for [n=1:4] data index part(n, " edge") using 1:(100*$5):(100*$6) with yerrorbars pt 7 ps 1 lw 1.5 lc rgb colour[n], \
     for [n=1:4] data index part(n, " chaos") using 1:(100*$5):(100*$6) with yerrorbars pt 6 ps 1.4 lw 1.5 lc rgb colour[n], \
     data index "n=0.2 old momentum:".q using 1:(100*$5):(100*$6) with yerrorbars pt 2 ps 1 lw 1.5 lc rgb blue
@finish
