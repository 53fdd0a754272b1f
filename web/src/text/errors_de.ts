/** What is said where something goes wrong: `{}` stands for what differs, and is taken over in its order. */
export const errorsInGerman: readonly (readonly [english: string, german: string])[] = [
  // The server, and what comes from it
  [
    "the server does not answer; is clipgs serve still running?",
    "Der Server antwortet nicht; läuft clipgs serve noch?",
  ],
  ["the server does not answer; is it still running?", "Der Server antwortet nicht; läuft er noch?"],
  [
    "the server has no such case (status {}); choose another",
    "Der Server hat diesen Fall nicht (Status {}); bitte einen anderen wählen",
  ],
  [
    "there is no such case; choose another from the menu",
    "Diesen Fall gibt es nicht; bitte einen anderen aus dem Menü wählen",
  ],
  [
    "the connection broke while the case was loading; try again",
    "Die Verbindung brach beim Laden des Falls ab; bitte erneut versuchen",
  ],
  [
    "a part of the viewer cannot be fetched ({}); try again",
    "Ein Teil des Betrachters lässt sich nicht laden ({}); bitte erneut versuchen",
  ],
  ["the folder of the cases cannot be read", "Der Ordner der Fälle lässt sich nicht lesen"],
  [
    "open the whole address that you were given, with the letters at its end",
    "Bitte die ganze Adresse öffnen, mit den Buchstaben am Ende",
  ],
  [
    "open the whole address that clipgs serve printed, with the letters at its end",
    "Bitte die ganze Adresse öffnen, die clipgs serve ausgab, mit den Buchstaben am Ende",
  ],
  [
    "the time of this address is over; ask for another",
    "Die Zeit dieser Adresse ist vorbei; bitte eine andere erbitten",
  ],
  ["too many wrong addresses; wait a little", "Zu viele falsche Adressen; bitte ein wenig warten"],
  [
    "your address lets you look alone; ask for one that may write",
    "Diese Adresse lässt nur schauen; bitte eine erbitten, mit der man schreiben darf",
  ],
  [
    "your address takes part in no study; ask for one that sees all cases and may write",
    "Mit dieser Adresse nimmt man an keiner Studie teil; bitte eine erbitten, die alle Fälle zeigt und schreiben lässt",
  ],
  [
    "it cannot be recorded who opens or changes this, so nobody can; tell who runs this server",
    "Es lässt sich nicht festhalten, wer dies öffnet oder ändert, darum kann es niemand; bitte dem Betreiber des Servers sagen",
  ],
  [
    "the tokens of this server cannot be read; tell who runs it to look at what it says",
    "Wer hier zugelassen ist, kann der Server nicht lesen; bitte dem Betreiber sagen, dass er nachsehe, was dieser meldet",
  ],
  [
    "{} cannot be written there; tell who runs this server",
    "{} lässt sich dort nicht schreiben; bitte dem Betreiber des Servers sagen",
  ],
  ["another case was chosen meanwhile", "Inzwischen wurde ein anderer Fall gewählt"],
  ["others change them all the time; try again", "Andere ändern sie ständig; bitte erneut versuchen"],
  ["the tour cannot be fetched ({})", "Die Tour lässt sich nicht laden ({})"],
  ["(no answer)", "(keine Antwort)"],
  ["the viewer is gone", "Den Betrachter gibt es nicht mehr"],
  ["these splats are disposed of", "Diese Splats gibt es nicht mehr"],
  // The browser and its headset
  [
    "this browser has no WebGL 2, which the viewer needs; update it or turn acceleration on",
    "Dieser Browser kann kein WebGL 2, das der Betrachter braucht; bitte erneuern oder die Beschleunigung einschalten",
  ],
  ["the headset does not start:", "Das Headset startet nicht:"],
  [
    "there is not enough memory for {} splats; close other tabs",
    "Der Speicher reicht nicht für {} Splats; bitte andere Tabs schließen",
  ],
  [
    "the file cannot be read, or there is not enough memory for it; choose it again",
    "Die Datei lässt sich nicht lesen, oder der Speicher reicht nicht für sie; bitte neu wählen",
  ],
  [
    "{} cannot be decoded: its worker stopped; reload the page",
    "{} lässt sich nicht entpacken: Der Hintergrundprozess endete; bitte die Seite neu laden",
  ],
  [
    "{} cannot be decoded, or there is not enough memory; copy the case again",
    "{} lässt sich nicht entpacken, oder der Speicher reicht nicht; bitte den Fall neu kopieren",
  ],
  [
    "{} has other slices than its section says; build the case again",
    "{} hat andere Schichten als beschrieben; bitte den Fall neu erzeugen",
  ],
  ["{} cannot be decoded:", "{} lässt sich nicht entpacken:"],
  ["the case cannot be shown:", "Der Fall lässt sich nicht zeigen:"],
  // Archives
  [
    "the file ends too early; copy it again, whole",
    "Die Datei endet zu früh; bitte noch einmal ganz kopieren",
  ],
  [
    "this is not a SOG file (no ZIP archive); choose a case made by clipgs build or pack",
    "Das ist keine SOG-Datei (kein ZIP-Archiv); bitte einen Fall von clipgs build oder pack wählen",
  ],
  [
    "is not a readable case, it is truncated or corrupt ({})",
    "ist kein lesbarer Fall, sondern abgeschnitten oder beschädigt ({})",
  ],
  [
    "the archive's directory is damaged; copy the file again",
    "Das Verzeichnis des Archivs ist beschädigt; bitte die Datei neu kopieren",
  ],
  [
    "the archive holds more than {} files; is it a case?",
    "Das Archiv enthält mehr als {} Dateien; ist es ein Fall?",
  ],
  [
    'the archive holds "{}" twice; the file is corrupt',
    "Das Archiv enthält „{}“ zweimal; die Datei ist beschädigt",
  ],
  [
    "the archive holds more than {} MiB; no case is that large",
    "Das Archiv enthält mehr als {} MiB; so groß ist kein Fall",
  ],
  [
    "is packed in a way that SOG does not use; pack the case again",
    "ist so gepackt, wie SOG es nicht kennt; bitte den Fall neu packen",
  ],
  [
    "is damaged (its checksum differs); copy the file again",
    "ist beschädigt (die Prüfsumme weicht ab); bitte die Datei neu kopieren",
  ],
  [
    "is damaged (it does not unpack); copy the file again",
    "ist beschädigt (lässt sich nicht entpacken); bitte die Datei neu kopieren",
  ],
  [
    "is damaged (it does not unpack); copy it again",
    "ist beschädigt (lässt sich nicht entpacken); bitte neu kopieren",
  ],
  [
    "is not where the archive's directory says; copy the file again",
    "liegt nicht dort, wo es im Verzeichnis des Archivs steht; bitte die Datei neu kopieren",
  ],
  ["is cut off; copy the file again, whole", "ist abgeschnitten; bitte die Datei noch einmal ganz kopieren"],
  [
    "does not decode to what was written (its checksum differs), so it is not shown; copy the case again, or use another browser",
    "ergibt entpackt nicht, was geschrieben wurde (die Prüfsumme weicht ab), und wird nicht gezeigt; bitte den Fall neu kopieren oder einen anderen Browser nehmen",
  ],
  // Cases
  [
    "this SOG has no clipgs block, which says how it lies in the patient; make it with clipgs pack",
    "Dieser SOG-Datei fehlt der clipgs-Block, der sagt, wie sie im Patienten liegt; bitte mit clipgs pack herstellen",
  ],
  [
    "the case is of a version that this viewer does not know; use a newer clipgs",
    "Der Fall hat eine Version, die dieser Betrachter nicht kennt; bitte ein neueres clipgs nehmen",
  ],
  [
    "the case's section is of a version that this viewer does not know; use a newer clipgs",
    "Das Schnittvolumen des Falls hat eine Version, die dieser Betrachter nicht kennt; bitte ein neueres clipgs nehmen",
  ],
  [
    'the case is shown by a tone curve "{}" that this viewer does not know; use a newer clipgs',
    "Der Fall wird mit einer Tonwertkurve „{}“ gezeigt, die dieser Betrachter nicht kennt; bitte ein neueres clipgs nehmen",
  ],
  ["is missing from the case; build or copy it again", "fehlt im Fall; bitte neu herstellen oder kopieren"],
  [
    "{} is {}, which does not fit the section; build the case again",
    "{} hat {} Bildpunkte, was nicht zum Schnittvolumen passt; bitte den Fall neu herstellen",
  ],
  [
    "{} is {}, too small for {} splats; build the case again",
    "{} hat {} Bildpunkte, zu wenig für {} Splats; bitte den Fall neu herstellen",
  ],
  [
    "splat {} has no valid rotation; build the case again",
    "Splat {} hat keine gültige Drehung; bitte den Fall neu herstellen",
  ],
  [
    "does not hold {} palette entries; build the case again",
    "enthält keine {} Einträge der Palette; bitte den Fall neu herstellen",
  ],
  ["splat {} names palette entry {} of", "Splat {} nennt Eintrag {} der Palette, von"],
  [
    "splat {} is of layer {} of {}; build the case again",
    "Splat {} liegt in Schicht {} von {}; bitte den Fall neu herstellen",
  ],
  [
    "there is no meta.json in the archive; this is not a SOG scene",
    "Im Archiv fehlt meta.json; das ist keine SOG-Szene",
  ],
  ['meta.json has no "{}"; this is not a SOG scene', "In meta.json fehlt „{}“; das ist keine SOG-Szene"],
  [
    "meta.json cannot be read as JSON; build the case again",
    "meta.json lässt sich nicht als JSON lesen; bitte den Fall neu herstellen",
  ],
  ["is not a list of {} file names", "ist keine Liste von {} Dateinamen"],
  ["is not a list of {} numbers", "ist keine Liste von {} Zahlen"],
  ["is not a whole number from {} to", "ist keine ganze Zahl von {} bis"],
  [
    "SOG version {} is not supported; convert the scene to version 2",
    "SOG-Version {} wird nicht unterstützt; bitte die Szene in Version 2 umwandeln",
  ],
  // Files of JSON
  ["is not an object;", "ist kein Objekt;"],
  ["is missing or out of range;", "fehlt oder liegt außerhalb des Erlaubten;"],
  ["; build the case again", "; bitte den Fall neu herstellen"],
  ["; save the marks again", "; bitte die Markierungen neu speichern"],
  ["; save the tour again", "; bitte die Tour neu speichern"],
  ["not a file of marks", "keine Datei mit Markierungen"],
  ["not a tour", "keine Tour"],
  [
    "of a version that this viewer does not know; use a newer clipgs",
    "von einer Version, die dieser Betrachter nicht kennt; bitte ein neueres clipgs nehmen",
  ],
  ["of another volume; open its case first", "eines anderen Volumens; bitte zuerst dessen Fall öffnen"],
  ["holds {} marks,", "enthält {} Markierungen,"],
  ["holds {} stops,", "enthält {} Ansichten,"],
  ["with those that are here, {} marks,", "mit den vorhandenen {} Markierungen,"],
  [", of which no more than {} can be shown", ", von denen sich höchstens {} zeigen lassen"],
  ["has more than {} MiB, which no such file has", "hat mehr als {} MiB, wie keine solche Datei"],
  ["has more than {} characters;", "hat mehr als {} Zeichen;"],
  // Scenes of other programs
  [
    "has no splats: what is packed in it is no SPZ scene",
    "hat keine Splats: Was darin gepackt ist, ist keine SPZ-Szene",
  ],
  ["has no splats: it has no points", "hat keine Splats: Es fehlen Punkte"],
  [
    'has no splats: its points have no "{}"; a scene of 3D Gaussians is needed',
    "hat keine Splats: Seinen Punkten fehlt „{}“; nötig ist eine Szene aus 3D-Gauß-Splats",
  ],
  ["has no splats that could be seen", "hat keine Splats, die zu sehen wären"],
  ["has no splats", "hat keine Splats"],
  [
    "has {} splats, and the viewer shows {} at most; thin it out, as in SuperSplat",
    "hat {} Splats, und der Betrachter zeigt höchstens {}; bitte ausdünnen, etwa in SuperSplat",
  ],
  [
    'has {} properties "f_rest_…", which fit no degree of spherical harmonics up to 3',
    "hat {} Eigenschaften „f_rest_…“, die zu keinem Grad von Kugelflächenfunktionen bis 3 passen",
  ],
  [
    "is damaged: it has fewer chunks or harmonics than splats; copy it again",
    "ist beschädigt, mit weniger Blöcken oder Kugelflächenfunktionen als Splats; bitte neu kopieren",
  ],
  [
    "is SPZ of version {}, and the viewer reads versions 2 to 4; save it as one of these",
    "ist SPZ der Version {}, und der Betrachter liest 2 bis 4; bitte so speichern",
  ],
  [
    "has harmonics of degree {}, and the viewer knows 0 to 3",
    "hat Kugelflächenfunktionen vom Grad {}, und der Betrachter kennt 0 bis 3",
  ],
  [
    'ends too early for {} of "{}"; copy it again, whole',
    "endet zu früh für {} von „{}“; bitte noch einmal ganz kopieren",
  ],
  ["ends too early; copy it again, whole", "endet zu früh; bitte noch einmal ganz kopieren"],
  [
    "is no PLY file that can be read: its header has no end",
    "ist keine lesbare PLY-Datei: Der Kopf hat kein Ende",
  ],
  ["is no PLY file that can be read:", "ist keine lesbare PLY-Datei:"],
  [
    "is no binary, little-endian PLY file; save it as one",
    "ist keine binäre PLY-Datei in Little-Endian; bitte so speichern",
  ],
  // Studies
  ["is no JSON ({}); see docs/study.md", "ist kein JSON ({}); siehe docs/study.md"],
  ["; see docs/study.md", "; siehe docs/study.md"],
  ["plan.tasks is empty or has a name twice", "plan.tasks ist leer oder hat einen Namen zweimal"],
  [
    'the target of "{}" is the pin "{}", which the plan does not have',
    "Das Ziel von „{}“ ist der Punkt „{}“, den der Plan nicht hat",
  ],
  [
    'its case "{}" is not served; put {} into the folder',
    "Der Fall „{}“ fehlt; bitte {} in den Ordner legen",
  ],
  [
    "has no section, so nothing can be marked in it; build it without --no-section",
    "hat kein Schnittvolumen, so dass sich darin nichts markieren lässt; bitte ohne --no-section herstellen",
  ],
  [
    'the target of "{}" is not in {}; is it the plan\'s case?',
    "Das Ziel von „{}“ liegt nicht in {}; ist es der Fall des Plans?",
  ],
  [
    "participant {} has taken part already; choose another number",
    "Nummer {} hat schon teilgenommen; bitte eine andere wählen",
  ],
  [
    "participant {} began with another text of {}; put that plan back, or choose another number",
    "Nummer {} begann mit einem anderen Text von {}; bitte jenen Plan zurücklegen oder eine andere Nummer wählen",
  ],
];
