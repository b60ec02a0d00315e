# Kinetic and collision viscosity of the Lowe-Andersen gas against the collision frequency; dashed: theory with memory, up to
# one update of a pair per step.
kin = ":kinetic_viscosity:ng8-lowe"; col = ":collision_viscosity:ng12-lowe"
kin_memory = ":kinetic_viscosity:memory-kinetic-lowe"; col_memory = ":collision_viscosity:memory-collision-lowe"
one = "dt=0.1"; rare = "dt=0.1, rare"; two = "dt=1"

@upper
set logscale xy
set xrange [0.2:40]; set yrange [0.06:200]
set ylabel "viscosity η*" offset 0.5,0
set key top left maxrows 3
plot lines index rare.kin using 1:2 with lines lw 2 lc rgb blue notitle, \
     lines index two.kin using 1:2 with lines lw 2 lc rgb sky notitle, \
     lines index rare.col using 1:2 with lines lw 2 lc rgb red notitle, \
     lines index one.kin_memory using 1:2 with lines lw 1.5 dt 2 lc rgb blue notitle, \
     lines index two.kin_memory using 1:2 with lines lw 1.5 dt 2 lc rgb sky notitle, \
     lines index one.col_memory using 1:2 with lines lw 1.5 dt 2 lc rgb red notitle, \
     lines index two.col_memory using 1:2 with lines lw 1.5 dt 2 lc rgb yellow notitle, \
     data index one.kin using 1:2:3 with yerrorbars pt 7 lw 1.5 lc rgb blue title "kinetic, Δt* = 0.1", \
     data index two.kin using 1:2:3 with yerrorbars pt 9 lw 1.5 lc rgb sky title "kinetic, Δt* = 1", \
     data index one.col using 1:2:3 with yerrorbars pt 5 lw 1.5 lc rgb red title "collision, Δt* = 0.1", \
     data index two.col using 1:2:3 with yerrorbars pt 13 lw 1.5 lc rgb yellow title "collision, Δt* = 1", \
     data index rare.kin using 1:2:3 with yerrorbars pt 7 lw 1.5 lc rgb blue notitle, \
     data index rare.col using 1:2:3 with yerrorbars pt 5 lw 1.5 lc rgb red notitle, \
     data index one." chaos".kin using 1:2:3 with yerrorbars pt 6 ps 1.4 lw 1.5 lc rgb blue notitle, \
     data index one." chaos, frequent".kin using 1:2:3 with yerrorbars pt 6 ps 1.4 lw 1.5 lc rgb blue notitle, \
     data index one." chaos".col using 1:2:3 with yerrorbars pt 4 ps 1.4 lw 1.5 lc rgb red notitle, \
     data index one." chaos, frequent".col using 1:2:3 with yerrorbars pt 4 ps 1.4 lw 1.5 lc rgb red notitle, \
     NaN with points pt 6 ps 1.4 lc rgb black title "positions redrawn", \
     NaN with lines lw 1.5 dt 2 lc rgb black title "with memory"
@lower
set xlabel "collision frequency Γτ_0" offset 0,0.4
set yrange [-60:60]
set key bottom left maxrows 1 samplen 0.8
plot 0 with lines lw 2 lc rgb grey notitle, \
     data index one.kin using 1:(100*$5):(100*$6) with yerrorbars pt 7 lw 1.5 lc rgb blue notitle, \
     data index rare.kin using 1:(100*$5):(100*$6) with yerrorbars pt 7 lw 1.5 lc rgb blue notitle, \
     data index rare.col using 1:(100*$5):(100*$6) with yerrorbars pt 5 lw 1.5 lc rgb red notitle, \
     data index two.kin using 1:(100*$5):(100*$6) with yerrorbars pt 9 lw 1.5 lc rgb sky notitle, \
     data index one.col using 1:(100*$5):(100*$6) with yerrorbars pt 5 lw 1.5 lc rgb red notitle, \
     data index two.col using 1:(100*$5):(100*$6) with yerrorbars pt 13 lw 1.5 lc rgb yellow notitle, \
     data index one." chaos".kin using 1:(100*$5):(100*$6) with yerrorbars pt 6 ps 1.4 lw 1.5 lc rgb blue notitle, \
     data index one." chaos, frequent".kin using 1:(100*$5):(100*$6) with yerrorbars pt 6 ps 1.4 lw 1.5 lc rgb blue notitle, \
     data index one." chaos".col using 1:(100*$5):(100*$6) with yerrorbars pt 4 ps 1.4 lw 1.5 lc rgb red notitle, \
     data index one." chaos, frequent".col using 1:(100*$5):(100*$6) with yerrorbars pt 4 ps 1.4 lw 1.5 lc rgb red notitle, \
     data index two." chaos".kin using 1:(100*$5):(100*$6) with yerrorbars pt 8 ps 1.4 lw 1.5 lc rgb sky notitle, \
     data index two." chaos".col using 1:(100*$5):(100*$6) with yerrorbars pt 12 ps 1.4 lw 1.5 lc rgb yellow notitle, \
     data index "2D chaos".kin using 1:(100*$5):(100*$6) with yerrorbars pt 6 ps 1.4 lw 1.5 lc rgb green title "2D, redrawn, kinetic", \
     data index "2D chaos".col using 1:(100*$5):(100*$6) with yerrorbars pt 4 ps 1.4 lw 1.5 lc rgb purple title "2D, redrawn, collision"
@finish
