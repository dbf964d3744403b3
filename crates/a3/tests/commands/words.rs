//! Messages about arguments that are not understood, word for word.

use crate::common::Folder;
use crate::refused;

/// Arguments, and the start of the message about them.
const WRONG: &[(&str, &str)] = &[
    ("simulte", "`simulte`: there is no such command or solver; did you mean simulate?"),
    ("simulat t 0.01", "`simulat`: there is no such command or solver; did you mean simulate?"),
    ("Render", "`Render`: there is no such command or solver; did you mean render?"),
    ("comp", "`comp`: there is no such command or solver; did you mean compare?"),
    ("trapzoid 0.01", "`trapzoid`: there is no such command or solver; did you mean trapezoid?"),
    ("T 0.01", "`T`: there is no such command or solver; did you mean t?"),
    ("q", "`q`: there is no such command or solver; `a3 --help` lists"),
    ("cloth", "`cloth`: a scene comes after --scene, as in `a3 --scene cloth`"),
    ("own.toml", "`own.toml`: a scene comes after --scene, as in `a3 --scene own.toml`"),
    ("t 1,5", "`1,5`: use a decimal point: 1.5"),
    ("t 10ms", "`10ms`: a step is a number of seconds from "),
    ("t -s", "there is no option `-s`: long options have two dashes, as in --scene, "),
    ("--sceen cloth", "there is no option `--sceen`; did you mean --scene?"),
    (
        "--scene clot",
        "`--scene clot`: there is no such scene; did you mean cloth? The scenes are cloth, ",
    ),
    ("--scene rug", "`--scene rug`: there is no such scene; the scenes are cloth, "),
    ("--scene /", "`--scene /`: this is a folder; the scenes are cloth, "),
    ("--scene", "`--scene` needs a value: `--scene NAME|FILE`, which is one of cloth, "),
    ("--scene gone.toml", "gone.toml: it could not be read: there is no such file or folder"),
    ("--resume gone", "gone: it could not be read: there is no such file or folder"),
    ("--wind=strong", "`--wind` takes no value: leave out strong"),
    ("--wind --wind", "`--wind` is there twice: give it once"),
    ("--colour sped", "`--colour sped`: did you mean speed? The choices are speed, strain, force"),
    ("--threads 1,5", "`--threads 1,5`: the number of threads is a whole number from 1 to "),
    ("simulate q", "`q`: there is no such solver; `a3 solvers` lists"),
    ("simulate trapezod", "`trapezod`: there is no such solver; did you mean trapezoid?"),
    ("simulate t 0.01", "`--output FILE` is missing; --help explains it"),
    ("simulate -o x.json --until 1,5", "`--until 1,5`: use a decimal point: 1.5"),
    ("simulate -o x.json --fps 29,97", "`--fps 29,97`: use a decimal point: 29.97"),
    (
        "simulate -o x.json --until 1 --summery s",
        "there is no option `--summery`; did you mean --summary?",
    ),
    (
        "chart --error postion",
        "`--error postion`: did you mean position? The choices are position, ",
    ),
    ("chart --stiffness a", "`--stiffness a`: a factor of the stiffness is a number from "),
    ("chart --solvers t,q", "`--solvers q`: there is no such solver; `a3 solvers`"),
    ("choose --error 1,5", "`--error 1,5`: use a decimal point: 1.5"),
    ("choose", "choose takes either --error E (in m) or --budget MS"),
    ("compare t:0,01 r", "`t:0,01`: use a decimal point: 0.01"),
    ("scenes --schema --print cloth", "give either `--schema` or `--print NAME`, not both"),
    ("scenes cloth", "`cloth` is one word too many; --help shows what is expected"),
    ("t 0.01 0.02", "`0.02` is one word too many; --help shows what is expected"),
    ("t 0.01 chart", "a command comes before everything else, as in `a3 chart --scene flag`"),
    (
        "--scene chain chart",
        "`chart`: a command comes before its options, as in `a3 chart --scene flag`",
    ),
    ("lessons 9", "`9`: lessons are numbered 1 to 8"),
    ("lessons x", "`x`: lessons are numbered 1 to 8"),
    ("render -o x.png --wireframe --springs", "give either `--wireframe` or `--springs`, not both"),
    ("scenes --list", "`--print NAME` is missing; --help explains it"),
    ("solvers --list", "there is no option `--list` here; --help lists the options"),
    ("completions bsh", "`bsh`: did you mean bash? The choices are bash, "),
    ("help simulte", "there is no command `simulte`; --help lists them"),
];

#[test]
fn words_that_are_not_understood_are_refused_in_plain_english() {
    let folder = &Folder::new();
    for (words, expected) in WRONG {
        let line = refused(folder, words, 2);
        assert!(line.starts_with(&format!("error: {expected}")), "a3 {words}\n{line}\n{expected}");
        for word in ["invalid value", "unexpected argument", "os error", "subcommand", "<"] {
            assert!(!line.contains(word), "{word} in {line}");
        }
    }
}
