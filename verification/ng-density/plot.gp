# Kinetic viscosity against the density at step 0.05, friction 1 and 9; below, the deviation from the theory with memory.
names = "gamma=1 gamma=9"
array colour[2] = [blue, red]
chaos(n) = word(names, n).":kinetic_viscosity:ng8"; memory(n) = word(names, n).":kinetic_viscosity:memory-kinetic"

@upper
set logscale xy
set xrange [0.9:11]; set yrange [0.03:3]
set ylabel "kinetic viscosity η*" offset 0.5,0
set key bottom right
plot for [n=1:2] lines index chaos(n) using 1:2 with lines lw 2 lc rgb colour[n] notitle, \
     for [n=1:2] lines index memory(n) using 1:2 with lines dt 2 lw 2 lc rgb colour[n] notitle, \
     for [n=1:2] data index chaos(n) using 1:2:3 with yerrorbars pt 7 lw 1.5 lc rgb colour[n] title "γ* = ".word(names, n)[7:], \
     data index "gamma=9, random order:kinetic_viscosity:ng8" using 1:2:3 with yerrorbars pt 6 ps 1.4 lw 1.5 lc rgb red title "the same, random order"
@lower
set xlabel "density n*" offset 0,0.4
set yrange [-20:20]
unset key
plot 0 with lines lw 2 lc rgb grey, \
     for [n=1:2] data index memory(n) using 1:(100*$5):(100*$6) with yerrorbars pt 7 lw 1.5 lc rgb colour[n], \
     data index "gamma=9, random order:kinetic_viscosity:memory-kinetic" using 1:(100*$5):(100*$6) with yerrorbars pt 6 ps 1.4 lw 1.5 lc rgb red
@finish
