# Temperature and velocity profiles in opposed Poiseuille flows, DPD and three kinds of rescaling.
names = "global layers monte_carlo DPD"
array colour[4] = [blue, green, purple, red]
array label[4] = ["rescaling, global", "rescaling, layers", "rescaling, Monte Carlo", "DPD"]
array symbol[4] = [7, 5, 9, 13]

@upper
set xrange [0:20]
set yrange [0.85:1.35]
set ylabel "temperature kT" offset 0.5,0
set key top center maxrows 2
plot 1 with lines lw 2 lc rgb grey notitle, \
     for [n=1:4] data index "all:T(y), ".word(names, n).":temperature_profile" using 1:2:3 with yerrorlines pt symbol[n] ps 0.6 lc rgb colour[n] title label[n]
@lower
set xlabel "height y*" offset 0,0.4
set ylabel "velocity v_x" offset 0.5,0
set yrange [*:*]
unset key
plot for [n=1:4] data index "all:V(y), ".word(names, n).":velocity_profile" using 1:2:3 with yerrorlines pt symbol[n] ps 0.6 lc rgb colour[n]
@finish
