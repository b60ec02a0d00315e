# Radial distribution function for different numbers of atoms per particle; below, at twenty, how far it changes with noise,
# temperature and thermostat.
atoms = "1 5 10 15 20 25 30"
array shade[7] = ["#440154", "#46327e", "#365c8d", "#1fa187", "#4ac16d", "#d0b010", "#e06000"]
variants = "'sigma=5' 'sigma=7' 'kT=0.01' 'kT=1' 'Lowe 0.5' 'Lowe 50'"
labels = "'σ_R = 5' 'σ_R = 7' 'kT = 0.01' 'kT = 1' 'Lowe, Γ = 0.5' 'Lowe, Γ = 50'"
array colour[6] = [blue, sky, red, yellow, green, purple]
array symbol[6] = [7, 6, 5, 4, 9, 8]

@upper
set xrange [0:3]; set yrange [0:2.3]
set ylabel "g(r)" offset 0.5,0
set key top right maxrows 2 title "N_m"
plot for [n=1:7] data index "all:Nm=".word(atoms, n).":radial_distribution" using 1:2 with lines lw 2 lc rgb shade[n] title word(atoms, n)
@lower
set xlabel "distance r (r_c)" offset 0,0.4
set ylabel "change of g (%)" offset 0.5,0
set yrange [-8:8]
set key bottom left maxrows 2 notitle
plot 0 with lines lw 2 lc rgb grey notitle, \
     for [n=1:6] data index word(variants, n).":radial_distribution:curve:Nm=20" using ($1 + 0.008*(n - 3.5)):(100*$5):(100*$6) with yerrorbars pt symbol[n] ps 0.9 lw 1.2 lc rgb colour[n] title word(labels, n)
@finish
