# D against the density at step 0.05, friction 1 and 9; below, the deviation from the theory with memory, and that of the pairs.
names = "gamma=1 gamma=9"
array colour[2] = [blue, red]
chaos(n) = word(names, n).":diffusion_constant:ng17"; memory(n) = word(names, n).":diffusion_constant:memory-D"
pairs(n) = word(names, n).":pair_density:value"

@upper
set logscale xy
set xrange [0.45:11]; set yrange [0.02:10]
set ylabel "diffusion constant D*" offset 0.5,0
set key top right
plot for [n=1:2] lines index chaos(n) using 1:2 with lines lw 2 lc rgb colour[n] notitle, \
     for [n=1:2] lines index memory(n) using 1:2 with lines dt 2 lw 2 lc rgb colour[n] notitle, \
     for [n=1:2] data index chaos(n) using 1:2:3 with yerrorbars pt 7 lw 1.5 lc rgb colour[n] title "γ* = ".word(names, n)[7:]
@lower
set xlabel "density n*" offset 0,0.4
set yrange [-10:10]
unset key
plot 0 with lines lw 2 lc rgb grey, \
     for [n=1:2] data index memory(n) using 1:(100*$5):(100*$6) with yerrorbars pt 7 lw 1.5 lc rgb colour[n], \
     for [n=1:2] data index pairs(n) using 1:(100*$5):(100*$6) with yerrorbars pt 6 lw 1.5 lc rgb colour[n]
@finish
