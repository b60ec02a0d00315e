# Velocity autocorrelations, their exponentials, the tail; below, the moment that is 1 for an exponential, against the
# strength of the potential and against the density.
names = "a=5 a=25 a=100"
array colour[3] = [blue, green, red]
c(n) = "all:C(t), ".word(names, n).":velocity_autocorrelation"
e(n) = "all:C(t), ".word(names, n).":exponential_decay"
tail = "all:tail, all lags:"

@upper
set bmargin at screen 0.545
set logscale y
set xrange [0:6]; set yrange [2e-4:1.5]
set format y "10^{%T}"
set xtics 1
set format x "%g"
set xlabel "time t*" offset 0,0.6
set ylabel "C(t*)" offset 0.5,0
set key top right maxrows 4
plot for [n=1:3] data index e(n) using 1:2 with lines dt 2 lw 1.5 lc rgb colour[n] notitle, \
     for [n=1:3] data index c(n) using 1:($1 <= 2 ? $2 : NaN) with points pt 7 ps 0.4 lc rgb colour[n] title "a = ".word(names, n)[3:], \
     data index tail."velocity_autocorrelation" using 1:2:3 every 2 with yerrorbars pt 6 ps 0.6 lc rgb purple title "ideal, γ* = 9", \
     data index tail."hydrodynamic_tail" using 1:2 with lines lw 2 lc rgb black title "shear modes", \
     data index tail."exponential_decay" using 1:2 with lines dt 3 lw 2 lc rgb purple notitle
unset xlabel
@lower
set tmargin at screen 0.455
unset key
set yrange [0.8:2.6]; set ytics 0.4
set rmargin at screen 0.54
set xlabel "potential strength a" offset 0,0.4
set ylabel "moment" offset 0.5,0
set xrange [0:105]; set xtics 25
set label 2 "n* = 3" at graph 0.06,0.88
plot 1 with lines lw 2 lc rgb grey, \
     data index "all:strength:correlation_moment" using 1:2:3 with yerrorlines pt 7 lw 1.5 lc rgb red
set lmargin at screen 0.58; set rmargin at screen 0.965
unset label 1; unset ylabel; set format y ""
set xlabel "density n*"
set xrange [0:6.5]; set xtics 1
set label 2 "a = 25"
plot 1 with lines lw 2 lc rgb grey, \
     data index "all:density:correlation_moment" using 1:2:3 with yerrorlines pt 5 lw 1.5 lc rgb blue
@finish
unset label 2
