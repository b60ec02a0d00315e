# Deviation of the simulation from the theory with memory, cell by cell; grey: what was expected beforehand, 8 %.
stats data index 0 nooutput
cells = 23
quantities = "kinetic_viscosity collision_viscosity diffusion_constant"
array colour[3] = [red, blue, green]
array mark[3] = [7, 5, 9]

set multiplot
set border 31 lw 1.2
set label 10 title_text at screen 0.53,0.975 center
set lmargin at screen 0.36; set rmargin at screen 0.97
set tmargin at screen 0.90; set bmargin at screen 0.16
set yrange [cells+0.6:0.4]; set xrange [-15:15]
set xlabel "simulation over theory, less 1, %" offset 0,0.4
set ytics scale 0 () font ",".(caption_size - 2)
do for [c=1:cells] { set ytics add (word_of(c) c) }
set object 1 rectangle from -8,0.4 to 8,cells+0.6 fc rgb "#eeeeee" fs solid noborder behind
set key outside top center horizontal samplen 1
plot for [q=1:3] for [c=1:cells] data index part(c, q) using (100*$5):(c + 0.22*(q-2)):(100*$6) with xerrorbars pt mark[q] ps 0.8 lw 1.5 lc rgb colour[q] notitle, \
     NaN with points pt 7 lc rgb red title "kinetic viscosity", NaN with points pt 5 lc rgb blue title "collision viscosity", NaN with points pt 9 lc rgb green title "D", \
     "+" using (0):($0) with lines lc rgb grey notitle
