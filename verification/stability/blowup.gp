# Kinetic temperature after each step, at the shortest step tried beyond each edge; friction 4.5, n = 3.
load scripts."/names.gp"
map = file("blowup")
set multiplot
set logscale xy
set xrange [1:700]
set format y "10^{%T}"
set ylabel "k_BT" offset 0.5,0
set lmargin at screen 0.12

set tmargin at screen 0.95; set bmargin at screen 0.71
set title "Just beyond the largest bounded step, no repulsion: blow-up" offset 0,-0.6
set format x ""
set yrange [0.3:1e7]; set ytics 100
set key top left maxrows 3 samplen 1.2
plot 1 with lines lw 2 lc rgb grey notitle, \
     for [k=1:5] map index name[k].":0:diverged" with lines lw 1.5 lc rgb colour[k] title name[k]

set tmargin at screen 0.665; set bmargin at screen 0.455
set title "The same with repulsion a = 25"
unset key
plot 1 with lines lw 2 lc rgb grey, \
     for [k=1:5] map index name[k].":25:diverged" with lines lw 1.5 lc rgb colour[k]

set tmargin at screen 0.41; set bmargin at screen 0.12
set title "Just beyond the largest usable step, a = 25: hot, but bounded"
set format x "10^{%T}"
set xlabel "steps" offset 0,0.4
set yrange [0.7:70]; set format y "%g"; set ytics 10
set key center right samplen 1.2
substeps = 9
plot 2 with lines lw 2 lc rgb grey notitle, \
     for [k=1:10] map index name[k].":25:hot" with lines lw (k == substeps ? 2 : 1) lc rgb (k == substeps ? colour[k] : "#999999") title k == substeps ? name[k] : k == 1 ? "the nine others" : ""
unset multiplot
