# Companion of every figure: error against run time. The caller sets data, caption, curves (how many), part and legend of
# each, least (smallest error), first and last (run time). Columns: seconds, error, deviation, points; of a floor:
# seconds, floor, its error, resolved.
array colour[7] = [blue, red, green, purple, sky, yellow, black]
array symbol[7] = [7, 5, 9, 11, 13, 6, 4]

set tmargin at screen 0.93; set bmargin at screen 0.43
set title title_text offset 0,-0.4
set label 1 caption at screen 0.025,0.135 noenhanced font ",".caption_size
set logscale xy
set format x "10^{%L}"; set format y "10^{%L}"
set xlabel "run time (s)" offset 0,0.4
set ylabel "relative error" offset 0.5,0
# with room for the floors; whole decades where none would be labelled
from = 0.7*first; to = 2.2*last
if (ceil(log10(from)) > floor(log10(to))) { from = 10**floor(log10(from)); to = 10**ceil(log10(to)) }
set xrange [from:to]; set yrange [10**floor(log10(0.3*least)):*]
set key at screen 0.03,0.345 left top Left reverse maxcols 1 samplen 2 noenhanced nobox font ",".caption_size
# grey: the slope -1/2 everywhere; floors: bars that begin beyond the last point
plot for [k=-8:8] 10**(0.5*k)/sqrt(x) noautoscale with lines lw 1 lc rgb "#cccccc" notitle, \
     for [n=1:curves] data index part[n] using 1:2 with lines dt (12, 6) lw 1.8 lc rgb colour[n] notitle, \
     for [n=1:curves] data index part[n] using 1:3 with points pt symbol[n] ps 1.2 lw 1.5 lc rgb colour[n] title legend[n], \
     for [n=1:curves] data index "floor:".part[n] using (1.2*$1):($4 > 0 ? $2 : NaN):(0.8*$1):(0) with vectors nohead lw 4 lc rgb colour[n] notitle
