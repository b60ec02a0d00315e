# Temperature against the density at step 0.2, with positions redrawn and without.
chaos = "chaos:kinetic_temperature:my22"

@upper
set logscale y
set xrange [0:0.75]; set yrange [0.4:20]
set ylabel "kinetic temperature" offset 0.5,0
set key top left
set arrow 1 from 0.6897,0.4 to 0.6897,20 nohead dt 2 lw 1.5 lc rgb grey
plot lines index chaos using 1:2 with lines lw 2 lc rgb grey title "eq. 22", \
     data index chaos using 1:2:3 with yerrorbars pt 6 ps 1.2 lw 1.5 lc rgb blue title "positions redrawn", \
     for [part in "fluid edge onset"] data index part.":kinetic_temperature:my22" using 1:2:3 with yerrorbars pt 7 lw 1.5 lc rgb red title part eq "fluid" ? "fluid" : ""
@lower
unset arrow 1
set xlabel "density" offset 0,0.4
set yrange [-20:20]
unset key
plot 0 with lines lw 2 lc rgb grey, \
     data index chaos using 1:(100*$5):(100*$6) with yerrorbars pt 6 ps 1.2 lw 1.5 lc rgb blue, \
     for [part in "fluid edge onset"] data index part.":kinetic_temperature:my22" using 1:(100*$5):(100*$6) with yerrorbars pt 7 lw 1.5 lc rgb red
@finish
