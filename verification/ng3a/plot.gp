# Kinetic, collision and potential viscosity against the friction.
names = "'n=1, weak' n=1"
kin = ":kinetic_viscosity:quantity:kinetic_viscosity_by_rates"
col = ":collision_viscosity:quantity:collision_viscosity_by_g"
pot(n) = "all:".word(names, n).":potential_viscosity"

@upper
set logscale xy
set xrange [0.4:25]; set yrange [0.003:2]
set ylabel "viscosity η*" offset 0.5,0
set key bottom right
plot for [n=1:2] data index word(names, n).kin using 1:4 with linespoints pt 1 lw 2 lc rgb blue notitle, \
     for [n=1:2] data index word(names, n).col using 1:4 with linespoints pt 1 lw 2 lc rgb red notitle, \
     for [n=1:2] data index word(names, n).kin using 1:2:3 with yerrorbars pt 7 lw 1.5 lc rgb blue title n == 2 ? "kinetic (line: eqs. 14, 16)" : "", \
     for [n=1:2] data index word(names, n).col using 1:2:3 with yerrorbars pt 5 lw 1.5 lc rgb red title n == 2 ? "collision (line: eq. 12)" : "", \
     for [n=1:2] data index pot(n) using 1:2:3 with yerrorbars pt 9 lw 1.5 lc rgb green title n == 2 ? "potential" : ""
@lower
set xlabel "friction γ*" offset 0,0.4
set yrange [-30:180]
unset key
plot 0 with lines lw 2 lc rgb grey, \
     for [n=1:2] data index word(names, n).kin using 1:(100*$5):(100*$6) with yerrorbars pt 7 lw 1.5 lc rgb blue, \
     for [n=1:2] data index word(names, n).col using 1:(100*$5):(100*$6) with yerrorbars pt 5 lw 1.5 lc rgb red
@finish
