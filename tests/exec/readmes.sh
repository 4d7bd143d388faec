#!/bin/sh
# The signposts are true: each folder of sources has a README, whose links lead somewhere and whose files exist; each .c and .h begins with a comment.
. tests/tap.sh

folders=$(find src runtime tests models -type f -name '*.[ch]' -o -type f -name '*.lag' | sed 's|/[^/]*$||' | LC_ALL=C sort -u | grep -v -e '^tests/' -e '^runtime/include$')
empty "each folder has a README" "$(for d in src runtime tests $folders; do [ -f "$d/README.md" ] || echo "$d"; done)"

pages=$(find . -name '*.md' -not -path './build/*' -not -path './.git/*' | LC_ALL=C sort)
# shellcheck disable=SC2086 # a list of files
empty "links of pages lead to files" "$(grep -Ho ']([^)#]*[)#]' $pages | sed 's/:](/ /; s/[)#]$//' | while read -r f l; do
  case $l in http* | '' | [0-9]*) ;; *) [ -e "${f%/*}/$l" ] || echo "$f: $l" ;; esac
done)"

# Sentences begin with their noun; only beginnings that never have one are looked for.
empty "no sentence of a page begins with That of, Those that, Of what, What no, What an" \
  "$(grep -nE '(^|[.] |[|] |- )(That of|Those that|Of what|What no|What an)( |$)' $pages)"

find src runtime tests grammar -type f | sed 's|.*/||' | LC_ALL=C sort -u >"$TMP/names"
printf '%s\n' math.h stddef.h stdio.h >>"$TMP/names"
empty "files that READMEs of sources name exist" "$(for f in src/README.md src/*/README.md runtime/README.md runtime/*/README.md tests/README.md; do
  grep -oE '(^|[^a-zA-Z0-9_{}-])[a-z_0-9]+\.[ch]\b' "$f" | grep -oE '[a-z_0-9]+\.[ch]$' | LC_ALL=C sort -u | grep -vxFf "$TMP/names" | sed "s|^|$f: |"
done)"

empty "the README of a folder names each of its .c files" "$(find src runtime -mindepth 2 -name '*.c' | LC_ALL=C sort | awk '
  {
    folder = name = $0; sub(/\/[^\/]*$/, "", folder); sub(/.*\//, "", name); sub(/\.c$/, "", name)
    if (!(folder in text)) while ((getline line <(folder "/README.md")) > 0) text[folder] = text[folder] " " line " "
    if (text[folder] !~ "[^a-z0-9_]" name "[^a-z0-9_]") print
  }')"

# ---- a course of mechanics, from energy to chaos: each of its topics and systems has models, which the table of models/README.md names
sed -n '/^## By topic/,/^## Three/p' models/README.md >"$TMP/topics"
without_model() {
  while IFS='|' read -r topic models; do
    for m in $models; do
      { [ -f "models/$m.lag" ] && [ -f "models/$m.facts" ]; } || echo "$topic: there is no model $m"
      grep -qF "[$m]($m.lag)" "$TMP/topics" || echo "$topic: the table does not name $m"
    done
  done
}
empty "each topic of the course has its models" "$(without_model <<'END'
energy is conserved: a ramp with friction on and off|skate_park
a skater draws in her arms|skater
elastic and inelastic collisions, momentum|collisions newtons_cradle
range and height of a throw, energy along the way|projectile projectile_world
work, power, forces that vary, mass that changes|rocket
oscillations and three regimes of damping|spring damped_oscillator
resonance|driven_damped_pendulum motor_pendulum
moments of inertia, torque, angular momentum|rolling_race rigid_body
Kepler's laws, speeds and periods of orbits|kepler two_body satellite
waves on a string|string
Lagrange's equations: pendulums|pendulum double_pendulum spherical_pendulum
beads on wires|bead_on_hoop bead_on_cycloid
bodies on a surface, multipliers|sphere cartesian_pendulum
Noether's theorem: time, space, rotation, gauge|two_body charged_particle
phase space, Poisson brackets|sommerfeld standard_map
canonical transformations, action and angle|delaunay pulled_pendulum
Hamilton and Jacobi: Kepler's problem, two centres, free fall|delaunay two_centres free_fall
chaos: neighbouring motions, sections|double_pendulum henon_heiles
tori that break: gaps among asteroids|asteroid
tori that break: rings of magnets|storage_ring
tori that break: magnetic surfaces, a particle in a torus|field_lines guiding_centre
a strange attractor|lorenz
geometric phases|foucault hannay_hoop
molecules|lennard_jones
planets; stars; three bodies, one of them small|outer_planets pleiades figure_eight cr3bp
charges in fields, plasma|charged_particle guiding_centre plasma
methods side by side|pendulum kepler
solitons, chains that do not forget, edges|toda fput edge_mode
fast particles, black holes, Mercury|relativistic_particle schwarzschild mercury
cranks, gears, pulleys|slider_crank gears pulleys
a car on a road, a ride|quarter_car roller_coaster
a pile of blocks|block tower
END
)"

empty "no line of C above 120 columns" "$(find src runtime tests grammar -name '*.[chl]' -exec awk 'length($0) > 120 { print FILENAME ":" FNR }' {} +)"
empty "each file of sources begins with a comment" "$(find src runtime -name '*.[ch]' -exec awk 'FNR == 1 && !/^\/\*/ { print FILENAME }' {} +)"
tap_end
