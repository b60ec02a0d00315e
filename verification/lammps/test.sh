#!/bin/sh
# The decks on LAMMPS itself; skipped (77) where no `lmp` with the packages DPD-BASIC and DPD-REACT is on the PATH.
# Usage: test.sh PATH_OF_LAMMPS_TEST
lmp -h 2>/dev/null | grep -q 'dpd/fdt' || { echo "skipped: no lmp with DPD-BASIC and DPD-REACT on the PATH"; exit 77; }
exec "$1" --run_test=engine
