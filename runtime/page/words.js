// The page's words, a row for each language; messages of liblag stay English. `data-word` of an element names its text, `data-label` its label.
const words = {
  en: {scene: "scene", effects: "effects", play: "Play", pause: "Pause", step: "Step", reset: "Reset", speed: "speed", back: "backwards", trace: "trace",
    twin: "a twin, started 1e-9 aside", estimate: "estimate the error", over: "over time", phase: "phase", against: "against", section: "section when",
    none: "(none)", rises: " rises through 0", parameters: "Parameters", start: "Start", accuracy: "Accuracy and cost", method: "method", automatic: "automatic",
    tolerance: "tolerance", stepsize: "step", link: "Copy link", embed: "Copy frame", print: "Print", equations: "Equations", values: "Values now", source: "The model's text",
    language: "language", picture: "the motion; drag a body to start it elsewhere; arrow keys move the view, + and - zoom", series: "quantities over time",
    portrait: "phase portrait", energy: "energy", drift: "drift", chosen: "chosen: ", steps: "steps", calls: "right-hand sides", cost: "ms of computing a second",
    slower: "slower than asked: this motion takes longer to compute than to watch", error: "error about", lost: "no digit is left after t =", apart: "the twin is aside by",
    ended: "an event ends the motion at t =", failed: "the motion stops at t =", again: "Reset begins again.", copied: "the link is in the clipboard",
    framed: "an iframe is in the clipboard", dear: "the estimate of the error is off: it took too long", now: "at t =", playing: "plays", shows: "shows", range: "back to the value before.",
    long: "The equations are too long for a page; `lagc derive` prints them.", section_points: "points of the section", distance: "distance of the twin",
    no_wasm: "This browser has no WebAssembly, with which the page computes; this is a recording.", no_record: "This browser has no WebAssembly, with which the page computes.",
    address: "What the address asks for is left out.", far: "more than 100 spans away; the page shows the start.", headings: {},
    keys: "Space: play or pause. Right arrow: step. R or Home: reset. On the picture: arrow keys, + and -."},
  de: {scene: "Szene", effects: "Effekte", play: "Start", pause: "Pause", step: "Schritt", reset: "Zurück", speed: "Tempo", back: "rückwärts", trace: "Spur",
    twin: "Zwilling, um 1e-9 versetzt", estimate: "Fehler schätzen", over: "über der Zeit", phase: "Phase", against: "gegen", section: "Schnitt, wenn",
    none: "(keiner)", rises: " durch 0 steigt", parameters: "Parameter", start: "Anfang", accuracy: "Genauigkeit und Aufwand", method: "Verfahren", automatic: "automatisch",
    tolerance: "Toleranz", stepsize: "Schrittweite", link: "Link kopieren", embed: "Rahmen kopieren", print: "Drucken", equations: "Gleichungen", values: "Werte jetzt", source: "Text des Modells",
    language: "Sprache", picture: "die Bewegung; ein Körper wird gezogen und beginnt dort neu; Pfeiltasten bewegen die Ansicht, + und - zoomen", series: "Größen über der Zeit",
    portrait: "Phasenbild", energy: "Energie", drift: "Drift", chosen: "gewählt: ", steps: "Schritte", calls: "rechte Seiten", cost: "ms Rechenzeit je Sekunde",
    slower: "langsamer als verlangt: Rechnen dauert länger als Zuschauen", error: "Fehler etwa", lost: "keine Ziffer stimmt mehr nach t =", apart: "Abstand des Zwillings",
    ended: "ein Ereignis beendet die Bewegung bei t =", failed: "die Bewegung endet bei t =", again: "„Zurück“ beginnt von vorn.", copied: "der Link ist in der Zwischenablage",
    framed: "ein iframe ist in der Zwischenablage", dear: "die Schätzung des Fehlers ist aus: sie dauerte zu lange", now: "bei t =", playing: "läuft", shows: "zeigt", range: "zurück zum Wert davor.",
    long: "Die Gleichungen sind zu lang für eine Seite; `lagc derive` druckt sie.", section_points: "Punkte des Schnitts", distance: "Abstand des Zwillings",
    no_wasm: "Dieser Browser hat kein WebAssembly, womit die Seite rechnet; dies ist eine Aufzeichnung.", no_record: "Dieser Browser hat kein WebAssembly, womit die Seite rechnet.",
    address: "Was die Adresse verlangt, entfällt.", far: "mehr als 100 Zeitspannen entfernt; die Seite zeigt den Anfang.",
    headings: {Lagrangian: "Lagrangefunktion", momenta: "Impulse", "equations of motion": "Bewegungsgleichungen", energy: "Energie", where: "wobei", constraints: "Zwangsbedingungen",
      "conditions of the constraints on accelerations": "Bedingungen der Zwänge an die Beschleunigungen", "constraints with a condition": "Zwänge mit einer Bedingung",
      "Hamilton's equations": "Hamiltons Gleichungen", Hamiltonian: "Hamiltonfunktion", "charges of symmetries": "Erhaltungsgrößen der Symmetrien"},
    keys: "Leertaste: Start oder Pause. Pfeil rechts: Schritt. R oder Pos1: von vorn. Auf dem Bild: Pfeiltasten, + und -."},
};
let language = "en";
const word = key => words[language][key];
function speak(wanted) {
  language = Object.hasOwn(words, wanted) ? wanted : "en";
  document.documentElement.lang = language;
  for (const e of document.querySelectorAll("[data-word]")) e.textContent = word(e.dataset.word);
  for (const e of document.querySelectorAll("[data-label]")) e.setAttribute("aria-label", word(e.dataset.label));
}
