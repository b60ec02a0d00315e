# Largest steps against repulsion, friction 4.5, n = 3; below, relative to the harmonic limit.
load scripts."/names.gp"
map = file("repulsion")
set multiplot
set logscale xy
set xrange [4:620]
set ylabel "largest step Δt" offset 0.5,0

set tmargin at screen 0.95; set bmargin at screen 0.55
set title "Largest usable step, density 3, friction 4.5" offset 0,-0.5
set format x ""
set yrange [1e-3:10]
unset key
plot map index name[1].":4.5" using 2:harmonic with lines lw 5 lc rgb "#cccccc" title "harmonic limit", \
     map index name[1].":4.5" using 2:hessian with lines lw 2 dt 2 lc rgb grey title "frozen Hessian", \
     for [k=1:10] map index name[k].":4.5" using 2:(edge(usable)) with linespoints pt symbol[k] ps 1 lw 1.5 lc rgb colour[k] title name[k]

set tmargin at screen 0.53; set bmargin at screen 0.22
unset title
set key at screen 0.53,0.075 center center maxrows 4 samplen 1.6 width -2
set format x "%g"
set xlabel "repulsion a" offset 0,0.4
unset logscale y
set yrange [0:1.3]
set ylabel "step/harmonic limit" offset 0.5,0
plot 1 with lines lw 5 lc rgb "#cccccc" title "harmonic limit", \
     map index name[1].":4.5" using 2:(column(hessian)/column(harmonic)) with lines lw 2 dt 2 lc rgb grey title "frozen Hessian", \
     for [k=1:10] map index name[k].":4.5" using 2:(edge(usable)/(k == 9 ? 10 : 1)/column(harmonic)) with linespoints pt symbol[k] ps 1 lw 1.5 lc rgb colour[k] title (k == 9 ? "S1, substep" : name[k])
unset multiplot
