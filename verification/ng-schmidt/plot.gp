# Schmidt number against the friction.
ideal = "ideal:schmidt_number:ng-schmidt"; limit = "limit:schmidt_number:ng-schmidt"

@upper
set logscale xy
set xrange [0.03:30]; set yrange [0.3:40]
set ylabel "Schmidt number Sc" offset 0.5,0
set key top left
plot 0.5 with lines dt 2 lw 1.5 lc rgb grey title "1/2", 1.7 with lines dt 3 lw 1.5 lc rgb grey title "1.7", \
     lines index ideal using 1:2 with lines lw 2 lc rgb blue title "eqs. 8, 12, 17", \
     data index ideal using 1:2:3 with yerrorbars pt 7 lw 1.5 lc rgb blue title "ideal gas", \
     data index limit using 1:2:3 with yerrorbars pt 6 ps 1.4 lw 1.5 lc rgb blue title "ideal gas, step 1", \
     data index "all:soft:schmidt_number" using 1:2:3 with yerrorbars pt 5 lw 1.5 lc rgb red title "soft potential, a = 25"
@lower
set xlabel "friction γ*" offset 0,0.4
set yrange [-60:30]
unset key
plot 0 with lines lw 2 lc rgb grey, data index ideal using 1:(100*$5):(100*$6) with yerrorbars pt 7 lw 1.5 lc rgb blue, \
     data index limit using 1:(100*$5):(100*$6) with yerrorbars pt 6 ps 1.4 lw 1.5 lc rgb blue
@finish
