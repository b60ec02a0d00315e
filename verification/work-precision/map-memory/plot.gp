# Deviation of the simulation from the theory with memory, cell by cell; grey: what was expected beforehand, 8 %. One line of
# the picture is one cell; two of them are points of parts with the same name.
list = "d=3_n=0.5_linear_dt=0.1 d=3_n=0.5_quadratic_dt=0.05 d=3_n=0.5_constant_dt=0.2 d=3_n=0.5_root_dt=0.02 d=3_n=2.0_linear_dt=0.5 d=3_n=2.0_linear_dt=0.05 d=3_n=2.0_quadratic_dt=0.1 d=3_n=2.0_constant_dt=0.02 d=3_n=2.0_root_dt=0.2 d=3_n=6.0_linear_dt=0.5 d=3_n=6.0_linear_dt=0.1 d=3_n=6.0_quadratic_dt=0.2 d=3_n=6.0_constant_dt=0.05 d=3_n=6.0_root_dt=0.1 d=2_n=0.5_linear_dt=0.5 d=2_n=2.0_linear_dt=0.05 d=2_n=2.0_quadratic_dt=0.2 d=2_n=6.0_constant_dt=0.1 d=2_n=6.0_root_dt=0.02 d=3_n=2.0_lowe_dt=0.1 d=3_n=6.0_lowe_dt=0.05 d=3_n=2.0_linear_dt=0.1"
curve(c) = system("echo '".word(list, c)."' | tr _ ' '")
suffix(c) = strstrt(word(list, c), "lowe") ? "-lowe" : ""
quantity(q) = word("kinetic_viscosity collision_viscosity diffusion_constant", q)
part(c, q) = curve(c).":".quantity(q).":memory-".word("kinetic collision D", q).suffix(c)
array colour[3] = [red, blue, green]
array mark[3] = [7, 5, 9]
cells = words(list)

set multiplot
set border 31 lw 1.2
set label 10 title_text at screen 0.53,0.972 center
set label 1 caption at screen 0.025,0.075 noenhanced font ",".caption_size
set lmargin at screen 0.36; set rmargin at screen 0.97
set tmargin at screen 0.875; set bmargin at screen 0.20
set yrange [cells+0.7:0.3]; set xrange [-15:25]
set xlabel "simulation over theory, less 1 (%)" offset 0,0.4
unset mytics
set ytics scale 0 () font ",".(caption_size - 1)
do for [c=1:cells] { set ytics add (system("echo '".curve(c)."' | sed 's/d=\\([23]\\)/\\1D,/; s/n=\\([0-9.]*\\)/n = \\1,/; s/ dt=/, Δt = /; s/lowe/Lowe-Andersen/'") c) }
set object 1 rectangle from -8,0.3 to 8,cells+0.7 fc rgb "#eeeeee" fs solid noborder behind
set arrow 1 from 0,0.3 to 0,cells+0.7 nohead lc rgb grey back
set key at screen 0.665,0.92 center center horizontal maxrows 1 samplen 1 width 1 nobox font ",".caption_size
plot for [q=1:3] for [c=1:cells] data index part(c, q) using (100*$5):(c + 0.24*(q-2)):(100*$6) with xerrorbars pt mark[q] ps 0.8 lw 1.5 lc rgb colour[q] notitle, \
     NaN with points pt 7 lc rgb red title "kinetic viscosity", NaN with points pt 5 lc rgb blue title "collision viscosity", NaN with points pt 9 lc rgb green title "diffusion constant"
unset multiplot
