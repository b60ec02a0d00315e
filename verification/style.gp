# Look and layout shared by all figures. A plot.gp draws two panels between `upper` and `lower`:
# value against theory above, relative deviation below. Columns of the data: x, value, error, theory,
# relative deviation, its error.

# colours that stay distinct for colour-blind readers (Okabe & Ito)
blue = "#0072B2"; red = "#D55E00"; green = "#009E73"; purple = "#CC79A7"; sky = "#56B4E9"; yellow = "#E69F00"
grey = "#777777"; black = "#000000"

set encoding utf8
set border lw 1.2
set tics scale 0.8
set mxtics; set mytics
set bars small
set style line 100 lc rgb "#e4e4e4" lw 1
set grid back ls 100
set key samplen 1.6 spacing 1.15 box lc rgb "#cccccc" opaque
set lmargin at screen 0.14
set rmargin at screen 0.965

# start of the upper and of the lower panel
upper = 'set multiplot; set tmargin at screen 0.93; set bmargin at screen 0.50; set title title_text offset 0,-0.4; \
set format x ""; unset xlabel; unset label'
lower = 'set tmargin at screen 0.47; set bmargin at screen 0.205; unset title; set format x; set format y "%g"; unset logscale y; \
set label 1 caption at screen 0.025,0.115 noenhanced font ",".caption_size; \
set ylabel "deviation (%)" offset -0.3,0'
finish = 'unset multiplot; unset label 1'

# the parts of a data file, by curve and quantity
points(curve, quantity) = curve.":".quantity
