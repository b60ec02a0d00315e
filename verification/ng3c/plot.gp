# Kinetic, collision and potential viscosity against the density.
kin = ":kinetic_viscosity:quantity:kinetic_viscosity_by_rates"
col = ":collision_viscosity:quantity:collision_viscosity_by_g"

@upper
set logscale y
set xrange [0.5:10.5]; set yrange [0.01:90]
set ylabel "viscosity η*" offset 0.5,0
set key top left maxrows 3
plot data index "a=25".kin using 1:4 with lines lw 2 lc rgb blue notitle, \
     data index "a=25".col using 1:4 with lines lw 2 lc rgb red notitle, \
     data index "a=25".kin using 1:2:3 with yerrorbars pt 7 lw 1.5 lc rgb blue title "kinetic, a = 25", \
     data index "a=25".col using 1:2:3 with yerrorbars pt 5 lw 1.5 lc rgb red title "collision, a = 25", \
     data index "all:a=25:potential_viscosity" using 1:2:3 with yerrorbars pt 9 lw 1.5 lc rgb green title "potential, a = 25", \
     data index "a=5".kin using 1:4 with lines lw 2 lc rgb sky notitle, \
     data index "a=5".col using 1:4 with lines lw 2 lc rgb yellow notitle, \
     data index "a=5".kin using 1:2:3 with yerrorbars pt 6 lw 1.5 lc rgb sky title "kinetic, a = 5", \
     data index "a=5".col using 1:2:3 with yerrorbars pt 4 lw 1.5 lc rgb yellow title "collision, a = 5", \
     data index "all:a=5:potential_viscosity" using 1:2:3 with yerrorbars pt 8 lw 1.5 lc rgb purple title "potential, a = 5"
@lower
set xlabel "density n*" offset 0,0.4
set yrange [-30:110]
unset key
plot 0 with lines lw 2 lc rgb grey, \
     data index "a=25".kin using 1:(100*$5):(100*$6) with yerrorbars pt 7 lw 1.5 lc rgb blue, \
     data index "a=25".col using 1:(100*$5):(100*$6) with yerrorbars pt 5 lw 1.5 lc rgb red, \
     data index "a=5".kin using 1:(100*$5):(100*$6) with yerrorbars pt 6 lw 1.5 lc rgb sky, \
     data index "a=5".col using 1:(100*$5):(100*$6) with yerrorbars pt 4 lw 1.5 lc rgb yellow
@finish
