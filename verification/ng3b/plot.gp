# Kinetic, collision and potential viscosity against the strength of the potential.
kin = ":kinetic_viscosity:quantity:kinetic_viscosity_by_rates"
col = ":collision_viscosity:quantity:collision_viscosity_by_g"
# A theory line of both parts of a curve, weak and strong potential, without a gap between them.
joined(n, q) = "< awk '/^#/ { on = $0 == \"# n=".n.q."\" || $0 == \"# n=".n.", strong".q."\" } on && /^[0-9]/' '".data."'"

@upper
set logscale y
set xrange [0:105]; set yrange [0.008:30]
set ylabel "viscosity η*" offset 0.5,0
set key top left maxrows 3
plot joined("3", kin) using 1:4 with lines lw 2 lc rgb blue notitle, \
     joined("3", col) using 1:4 with lines lw 2 lc rgb red notitle, \
     data index "n=3".kin using 1:2:3 with yerrorbars pt 7 lw 1.5 lc rgb blue title "kinetic, n* = 3", \
     data index "n=3".col using 1:2:3 with yerrorbars pt 5 lw 1.5 lc rgb red title "collision, n* = 3", \
     data index "all:n=3:potential_viscosity" using 1:2:3 with yerrorbars pt 9 lw 1.5 lc rgb green title "potential, n* = 3", \
     data index "n=3, strong".kin using 1:2:3 with yerrorbars pt 7 lw 1.5 lc rgb blue notitle, \
     data index "n=3, strong".col using 1:2:3 with yerrorbars pt 5 lw 1.5 lc rgb red notitle, \
     data index "all:n=3, strong:potential_viscosity" using 1:2:3 with yerrorbars pt 9 lw 1.5 lc rgb green notitle, \
     joined("1", kin) using 1:4 with lines lw 2 lc rgb sky notitle, \
     joined("1", col) using 1:4 with lines lw 2 lc rgb yellow notitle, \
     data index "n=1".kin using 1:2:3 with yerrorbars pt 6 lw 1.5 lc rgb sky title "kinetic, n* = 1", \
     data index "n=1".col using 1:2:3 with yerrorbars pt 4 lw 1.5 lc rgb yellow title "collision, n* = 1", \
     data index "all:n=1:potential_viscosity" using 1:2:3 with yerrorbars pt 8 lw 1.5 lc rgb purple title "potential, n* = 1", \
     data index "n=1, strong".kin using 1:2:3 with yerrorbars pt 6 lw 1.5 lc rgb sky notitle, \
     data index "n=1, strong".col using 1:2:3 with yerrorbars pt 4 lw 1.5 lc rgb yellow notitle, \
     data index "all:n=1, strong:potential_viscosity" using 1:2:3 with yerrorbars pt 8 lw 1.5 lc rgb purple notitle
@lower
set xlabel "potential strength a" offset 0,0.4
set yrange [-60:180]
unset key
plot 0 with lines lw 2 lc rgb grey, \
     data index "n=3".kin using 1:(100*$5):(100*$6) with yerrorbars pt 7 lw 1.5 lc rgb blue, \
     data index "n=3".col using 1:(100*$5):(100*$6) with yerrorbars pt 5 lw 1.5 lc rgb red, \
     data index "n=3, strong".kin using 1:(100*$5):(100*$6) with yerrorbars pt 7 lw 1.5 lc rgb blue, \
     data index "n=3, strong".col using 1:(100*$5):(100*$6) with yerrorbars pt 5 lw 1.5 lc rgb red, \
     data index "n=1".kin using 1:(100*$5):(100*$6) with yerrorbars pt 6 lw 1.5 lc rgb sky, \
     data index "n=1".col using 1:(100*$5):(100*$6) with yerrorbars pt 4 lw 1.5 lc rgb yellow, \
     data index "n=1, strong".kin using 1:(100*$5):(100*$6) with yerrorbars pt 6 lw 1.5 lc rgb sky, \
     data index "n=1, strong".col using 1:(100*$5):(100*$6) with yerrorbars pt 4 lw 1.5 lc rgb yellow
@finish
