# Pairs of an ideal gas against friction. Run from the repository's root; orders.py --old does.
set terminal svg size 700,460 font "Helvetica,14" background rgb "white"
set output "figures/orders/orders.svg"
load "verification/style.gp"
set xlabel "friction"; set ylabel "pairs within the cutoff over those of an ideal gas"
set logscale x; set xrange [2:300]; set yrange [0.99:1.004]; set format y "%.3f"
set key bottom left
plot 1.0 with lines lc rgb grey title "exact", \
     "figures/orders/forgetful.dat" index 0 using 1:2:3 with yerrorbars pt 6 lc rgb red title "as last sorted (revision 1)", \
     "" index 1 using 1:2:3 with yerrorbars pt 7 lc rgb blue title "by ids within a cell"
