"""`cgff convert`: which format is meant, where words go, what is refused."""

import pytest

from tests.formats.folder import FILES

NET = "v 0 0 0\nv 1 0 0\nv 1 1 0\ng ties\nl 1 2\nl 2 3\n"


@pytest.fixture
def here(run, tmp_path):
    """Run `cgff` where the files of other programs are."""
    for path in FILES.iterdir():
        (tmp_path / path.name).write_text(path.read_text())
    (tmp_path / "net.obj").write_text(NET)
    return run


def test_what_is_assumed_stands_in_the_scene_and_what_is_left_out_on_standard_error(here):
    result = here("convert", "3prism.yaml", "--strut-EA", "1e6")
    assert result.exit_code == 0
    assert result.stderr == "cgff: 3prism.yaml: left out: parameters of builders: damping, density, radius\n"
    assert result.stdout.startswith(
        "# converted from 3prism.yaml, a NASA NTRT structure\n# units are the file's"
    )
    assert "\n# a rod is rigid in NTRT; here EA 1000000.0, as given, and l0 its length\n" in result.stdout
    assert here("convert", "-q", "3prism.yaml", "--strut-EA", "1e6").stderr == ""
    assert here("solve", "-", stdin=result.stdout).exit_code == 0


def test_other_commands_say_what_such_a_file_is_and_how_to_convert_it(here):
    for command in ("solve", "check", "prestress", "analyse"):
        result = here(command, "3prism.yaml")
        assert (result.exit_code, result.stdout) == (3, "")
        assert result.stderr == (
            "3prism.yaml:2:1: this is a NASA NTRT structure, not a scene; make it one: "
            "cgff convert 3prism.yaml --strut-EA X -o scene.yaml\n"
        )
    text = (FILES / "xframe.yaml").read_text()
    assert here("check", "-", stdin=text).stderr.endswith("cgff convert - --from byu -o scene.yaml\n")
    assert here("convert", "-", "--from", "byu", "-q", stdin=text).exit_code == 0


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        (
            "net.obj",
            NET,
            "this is an OBJ file, not a scene; make it one: cgff convert net.obj --law",
        ),
        (
            "net.obj",
            "v 0 0 0\nv 1 0 0\ng a: b\nl 1 2\n",
            "this is an OBJ file, not a scene; make it one: cgff convert net.obj",
        ),
        ("-", NET, "this is an OBJ file, not a scene; make it one: cgff convert - --from obj --law LAW"),
        (
            "edges.csv",
            "start,end,EA\na,b,5\n",
            "this is a list of edges, not a scene; make it one: cgff convert edges.csv --nodes FILE.csv "
            "--law LAW --kind KIND -o scene.yaml\n",
        ),
        (
            "rows.csv",
            "struts.EA,verdict,converged,stability,iterations,residual_relative,energy\n1,x,true,,0,0,0\n",
            "these are rows of cgff sweep, not a scene; draw them: cgff plot --sweep rows.csv -o FILE.png\n",
        ),
        ("nodes.csv", "name,x,y\na,0,0\n", "this is a table, not a scene; a scene may name it, as in nodes:"),
    ],
)
def test_a_file_that_is_no_scene_is_told_by_its_look_with_what_takes_it(here, tmp_path, name, text, said):
    (tmp_path / name).write_text(text)
    for command in ("solve", "check", "analyse", "prestress"):
        result = here(command, name, stdin=text)
        assert (result.exit_code, result.stdout) == (3, "")
        assert result.stderr.startswith(f"{'<stdin>' if name == '-' else name}:1:1: {said}")


@pytest.mark.parametrize("text", ["", "just words\n", "- a list\n- of, words\n", "v: 1\nl: 2\n"])
def test_what_looks_like_nothing_known_is_told_as_before(here, text):
    assert "not a scene" not in here("check", "-", stdin=text).stderr


def test_all_that_is_not_said_is_asked_for_at_once(here, tmp_path):
    (tmp_path / "edges.csv").write_text("start,end\na,b\n")
    law = "says no law: give --law hooke or --law paper"
    kind = "it does not say what is a cable and what is a strut: give --kind cable or --kind GROUP=strut, for"
    for command, told in (
        (("net.obj",), f"an OBJ file {law}; {kind} 'ties'; it says no EA: give --EA"),
        (
            ("net.obj", "--kind", "strut", "--law", "paper"),
            "an OBJ file says no EA of its struts: give --EA or",
        ),
        (
            ("net.obj", "--kind", "cable", "--strut-EA", "1"),
            f"an OBJ file {law}; it says no EA of its cables",
        ),
        (
            ("edges.csv",),
            "this list of edges needs its nodes: give --nodes FILE.csv with columns name,x,y[,z]; "
            f"it {law}; {kind} 'elements'; it says no EA: give --EA",
        ),
    ):
        assert here("convert", *command).stderr.startswith(f"cgff: {told}")


def test_a_scene_with_a_stray_key_of_another_program_is_still_a_scene(here):
    result = here("check", "-", stdin="law: paper\nnodes: {a: [0, 0]}\npair_groups: {}\n")
    assert "not a scene" not in result.stderr
    assert "unknown key 'pair_groups'" in result.stderr


def test_suffixes_choose_the_formats_and_flags_overrule_only_silence(here, tmp_path):
    given = ("--law", "hooke", "--EA", "5", "--kind", "ties=cable")
    assert here("convert", "net.obj", *given, "-o", "net.yaml").exit_code == 0
    assert here("check", "net.yaml").stdout.startswith("net.yaml: ok: 3 nodes, 2 elements in 1 group")
    assert here("convert", "net.yaml", "-o", "back.obj").exit_code == 0
    lines = (tmp_path / "back.obj").read_text().splitlines()
    assert lines[1:] == ["v 0.0 0.0 0.0", "v 1.0 0.0 0.0", "v 1.0 1.0 0.0", "g ties", "l 1 2", "l 2 3"]
    assert here("convert", "net.yaml", "--to", "obj").stdout.splitlines() == lines


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("net.obj",), "an OBJ file says no law: give --law hooke or --law paper"),
        (("3prism.yaml",), "rods are rigid in NTRT: give their stiffness by --strut-EA, a force per length"),
        (("prism.yaml", "--law", "paper"), "--law has no place: a scene or a result needs none"),
        (("prism.yaml", "--to", "vtu"), "VTU is no text: give -o FILE.vtu"),
        (("prism.yaml", "--to", "obj", "-o", "x.dxf"), "--to obj and -o x.dxf disagree"),
        (
            ("prism.yaml", "-o", "x.txt"),
            "the name must end in .yaml (a scene), .yml (a scene), .obj, .vtu or .dxf",
        ),
        (("x.vtu",), "x.vtu: cannot read the file: no such file"),
        (
            ("net.obj", "--law", "paper", "--EA", "1", "--kind", "rope"),
            "--kind must be cable or strut, got 'rope'",
        ),
        (("net.obj", "--kind", "cable", "--kind", "strut"), "--kind is given twice"),
        (("net.obj", "--kind", "ties=cable", "--kind", "ties=strut"), "--kind ties is given twice"),
        (("net.obj", "--EA", "0"), "EA must be a number > 0, got 0.0"),
        (
            ("prism.yaml", "-o", "prism.yaml"),
            "prism.yaml would be written over the file it is converted from",
        ),
        (
            ("spine.yaml", "--strut-EA", "1", "-o", "3prism.yaml"),
            "would be written over a file of spine.yaml",
        ),
        (("-", "--nodes", "-"), "standard input (-) can be read only once"),
    ],
)
def test_what_is_wrong_with_the_command_is_said_and_nothing_written(here, tmp_path, arguments, said):
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    result = here("convert", *arguments)
    assert result.exit_code == (3 if "no such file" in said else 2)
    assert result.stdout == ""
    assert said in result.stderr
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_bad_file_ends_with_3_and_every_problem(here, tmp_path):
    (tmp_path / "net.obj").write_text(NET + "l 1 9\nl x 1\n")
    result = here("convert", "net.obj")
    assert (result.exit_code, result.stderr) == (
        3,
        "net.obj:7:5: there is no vertex 9; the file has 3 vertices\n"
        "net.obj:8:3: must be the number of a vertex, from 1, got 'x'\n",
    )
