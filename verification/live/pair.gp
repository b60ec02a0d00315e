# The still picture of the live page "One pair". Run from the repository's root; pair.py does.
set terminal svg size 800,430 font "Helvetica,15" background rgb "white"
set output "figures/live/pair.svg"
load "verification/style.gp"
set lmargin at screen 0.10; set rmargin at screen 0.97; set tmargin at screen 0.95; set bmargin at screen 0.15
set xlabel "time"
set ylabel "temperature kT, mean over pairs" offset 1,0
set xrange [0:5.2]; set yrange [0:*]
set key top left
plot 1 with lines lw 1.5 dt 2 lc rgb grey title "σ²/(2γ)", \
     "figures/live/pair.dat" index "noise alone" using 1:2:3 with yerrorlines pt 7 ps 0.9 lw 2 lc rgb red title "noise alone", \
     "" index "friction and noise" using 1:2:3 with yerrorlines pt 7 ps 0.9 lw 2 lc rgb green title "friction and noise", \
     "" index "friction alone" using 1:2:3 with yerrorlines pt 7 ps 0.9 lw 2 lc rgb blue title "friction alone"
