# shellcheck shell=sh
# For tests of what effects cost and matter: a mass that constant forces push, so that x = F t^2/2m and every error is a ratio of forces.
# push_model <TEXT: the model, and more effects and scenes.
push_model() {
  cat <<'TEXT'
model push "A mass, and what pushes it"
coord x [m]
param m = 2 [kg] > 0, F = 2 [N]
lagrangian = m/2*x'^2 + F*x
effect hand { param f = 1 [N]; force x = f }
effect breath { param f = 1e-3 [N]; force x = f }
effect there { param f = 0.5 [N]; force x = f }
effect back { param f = 0.5 [N]; force x = -f }
effect wall { event hit: x - 0.5 [m] rising { stop } }
TEXT
  cat
}
calc() { awk "BEGIN { printf \"%.15g\", $1 }"; }
