# Kinetic and collision viscosity against the density at time step 1, friction 1 and 9; dashed: theory with memory.
names = "gamma=1 gamma=9"
array colour_kin[2] = [blue, red]
array colour_col[2] = [sky, yellow]
kin = ":kinetic_viscosity:ng8"; col = ":collision_viscosity:ng12"
part(n, q) = word(names, n).q
kin_memory = ":kinetic_viscosity:memory-kinetic"; col_memory = ":collision_viscosity:memory-collision"

@upper
set logscale xy
set xrange [0.9:11]; set yrange [0.0003:12]; set ytics (0.01, 0.1, 1, 10)
set ylabel "viscosity η*" offset 0.5,0
set key bottom right maxrows 3
plot for [n=1:2] lines index part(n, kin) using 1:2 with lines lw 2 lc rgb colour_kin[n] notitle, \
     for [n=1:2] lines index part(n, col) using 1:2 with lines lw 2 lc rgb colour_col[n] notitle, \
     for [n=1:2] lines index part(n, kin_memory) using 1:2 with lines lw 1.5 dt 2 lc rgb colour_kin[n] notitle, \
     for [n=1:2] lines index part(n, col_memory) using 1:2 with lines lw 1.5 dt 2 lc rgb colour_col[n] notitle, \
     for [n=1:2] data index part(n, kin) using 1:2:3 with yerrorbars pt 7 lw 1.5 lc rgb colour_kin[n] title "kinetic, γ* = ".word(names, n)[7:], \
     for [n=1:2] data index part(n, col) using 1:2:3 with yerrorbars pt 5 lw 1.5 lc rgb colour_col[n] title "collision, γ* = ".word(names, n)[7:], \
     NaN with lines lw 1.5 dt 2 lc rgb black title "with memory"
@lower
set ytics auto
set xlabel "density n*" offset 0,0.4
set yrange [-20:20]
unset key
plot 0 with lines lw 2 lc rgb grey, \
     for [n=1:2] data index part(n, kin) using 1:(100*$5):(100*$6) with yerrorbars pt 7 lw 1.5 lc rgb colour_kin[n], \
     for [n=1:2] data index part(n, col) using 1:(100*$5):(100*$6) with yerrorbars pt 5 lw 1.5 lc rgb colour_col[n]
@finish
