# Viscosity against the strength of the potential with rescaling, often and rarely, and with DPD; below, the deviation from rescaling rarely.
@upper
set xrange [0:60]; set yrange [0:2.2]
set ylabel "viscosity η*" offset 0.5,0
set key top right
plot data index "all:DPD:viscosity" using 1:2:3 with yerrorlines pt 5 lw 1.5 lc rgb red title "DPD, γ* = 4.5", \
     data index "all:rescaling:viscosity" using 1:2:3 with yerrorlines pt 7 lw 1.5 lc rgb blue title "rescaling every 0.1", \
     data index "all:rarely:viscosity" using ($1+1):2:3 with yerrorbars pt 6 ps 1.3 lw 1.5 lc rgb green title "every 1 (at a + 1)"
@lower
set xlabel "potential strength a" offset 0,0.4
set ylabel "deviation from every 1 (%)" offset 0.5,0
set yrange [-15:15]
unset key
plot 0 with lines lw 2 lc rgb grey, \
     data index "rescaling:viscosity:curve:rarely" using 1:(100*$5):(100*$6) with yerrorlines pt 7 lw 1.5 lc rgb blue
@finish
