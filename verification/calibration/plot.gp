# Scatter over stated error, by scene. Run from the repository's root; calibrate.py does.
set terminal svg size 800,1080 font "Helvetica,13" background rgb "white"
set output "figures/calibration/calibration.svg"
load "verification/style.gp"
set lmargin at screen 0.36; set rmargin at screen 0.97; set tmargin at screen 0.93; set bmargin at screen 0.08
set xlabel "scatter of runs over their stated error"
set xrange [0.7:1.5]; set yrange [*:*] reverse; set offsets 0, 0, 1, 1
set ytics nomirror
set key at screen 0.66, 0.985 center top horizontal maxrows 2
unset mytics
set arrow 1 from 1, graph 0 to 1, graph 1 nohead lw 2 lc rgb grey back
scenes = "gas gas-shear soft soft-shear opposed rescaled"
array colour[6] = [blue, sky, red, yellow, green, purple]
plot for [n=1:6] "figures/calibration/stated_errors.dat" index word(scenes, n) \
     using 2:1:3:ytic(4) with xerrorbars pt 7 ps 0.8 lw 1.5 lc rgb colour[n] title word(scenes, n)
