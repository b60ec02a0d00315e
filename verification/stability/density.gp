# Largest steps against density, friction 4.5: above without repulsion, below with a = 25. The line of eq. 25 is that of
# eq. 26 read the other way round.
load scripts."/names.gp"
map = file("density")
set multiplot
set logscale xy
set xrange [0.9:22]
set ylabel "largest step Δt" offset 0.5,0

set tmargin at screen 0.95; set bmargin at screen 0.61
set title "Largest step at friction 4.5: usable (symbols), bounded (dotted)" offset 0,-0.5
set format x ""
set yrange [0.02:3]
set label 1 "no repulsion" at graph 0.97,0.93 right
unset key
plot map index name[1].":0" using 3:critical with lines lw 5 lc rgb "#cccccc", \
     map index name[1].":0" using 3:(column(rates)) with lines lw 2 dt 2 lc rgb "#e0a080", \
     for [k=1:5] map index name[k].":0" using 3:(edge(bounded)) with lines lw 1.5 dt 3 lc rgb colour[k], \
     for [k=1:5] map index name[k].":0" using 3:(edge(usable)) with linespoints pt symbol[k] ps 1 lw 1.5 lc rgb colour[k]

set tmargin at screen 0.59; set bmargin at screen 0.25
unset title
set format x "%g"
set xlabel "density n" offset 0,0.4
set yrange [0.003:3]
set label 1 "repulsion a = 25"
set key at screen 0.53,0.09 center center maxrows 5 samplen 1.2 width -2
plot map index name[1].":25" using 3:critical with lines lw 5 lc rgb "#cccccc" title "MY1997 eq. 25", \
     map index name[1].":25" using 3:harmonic with lines lw 5 lc rgb "#f0d0d0" title "harmonic limit", \
     map index name[1].":25" using 3:(column(rates)) with lines lw 2 dt 2 lc rgb "#e0a080" title "frozen friction", \
     map index name[1].":25" using 3:hessian with lines lw 2 dt 2 lc rgb grey title "frozen Hessian", \
     for [k=1:5] map index name[k].":25" using 3:(edge(bounded)) with lines lw 1.5 dt 3 lc rgb colour[k] notitle, \
     for [k=1:10] map index name[k].":25" using 3:(edge(usable)) with linespoints pt symbol[k] ps 1 lw 1.5 lc rgb colour[k] title name[k]
unset multiplot
