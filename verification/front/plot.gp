# The picture of README.md. Run from the repository's root; front.py does.
set terminal svg size 800,430 font "Helvetica,15" background rgb "white"
set output "figures/front.svg"
load "verification/style.gp"
set lmargin at screen 0.10; set rmargin at screen 0.97; set tmargin at screen 0.95; set bmargin at screen 0.15
set xlabel "time step"
set ylabel "temperature (1 is right)" offset 1,0
set logscale y
set xrange [0:0.82]; set yrange [0.75:40]
set ytics (1, 2, 5, 10, 20)
unset key
set label 1 "all pairs at once:\nthe fluid heats, then boils" at 0.12,14 tc rgb red
set label 2 "pair after pair: exact at any step" at 0.45,1.25 tc rgb blue
set label 3 "the formula of 1997,\nfor particles that meet strangers" at 0.49,11 tc rgb grey font ",13"
plot "figures/front.dat" index "eq. 22" using 1:2 with lines lw 2 lc rgb grey, \
     "" index "Euler" using 1:2:3 with yerrorlines pt 7 ps 0.9 lw 2 lc rgb red, \
     "" index "S1" using 1:2:3 with yerrorlines pt 7 ps 0.9 lw 2 lc rgb blue
