# Kinetic, collision and potential viscosity against the friction.
kin = "n=1:kinetic_viscosity:quantity:kinetic_viscosity_by_rates"
col = "n=1:collision_viscosity:quantity:collision_viscosity_by_g"
pot = "all:n=1:potential_viscosity"

@upper
set logscale xy
set xrange [0.4:25]; set yrange [0.003:2]
set ylabel "viscosity {/Symbol h}*" offset 0.5,0
set key bottom right
plot data index kin using 1:4 with lines lw 2 lc rgb blue notitle, \
     data index col using 1:4 with lines lw 2 lc rgb red notitle, \
     data index kin using 1:2:3 with yerrorbars pt 7 lw 1.5 lc rgb blue title "kinetic (line: eqs. 14, 16)", \
     data index col using 1:2:3 with yerrorbars pt 5 lw 1.5 lc rgb red title "collision (line: eq. 12)", \
     data index pot using 1:2:3 with yerrorbars pt 9 lw 1.5 lc rgb green title "potential"
@lower
set xlabel "friction {/Symbol g}*" offset 0,0.4
set yrange [-30:180]
unset key
plot 0 with lines lw 2 lc rgb grey, \
     data index kin using 1:(100*$5):(100*$6) with yerrorbars pt 7 lw 1.5 lc rgb blue, \
     data index col using 1:(100*$5):(100*$6) with yerrorbars pt 5 lw 1.5 lc rgb red
@finish
