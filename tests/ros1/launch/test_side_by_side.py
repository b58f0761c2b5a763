"""Launch files are read as by ROS's own roslaunch."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import pytest
import yaml
from recorded_answers import Answers

from fibws.ros1.launch.reader import LaunchReader

from .conftest import FakeEnvironment

SCRIPT = """
import contextlib, io, json, os, sys
sys.argv[1:], files = [], json.loads(sys.argv[1])
import roslaunch.xmlloader, roslaunch.config, rosgraph.names
rosgraph.names.anonymous_name = lambda name: name + "_host_1"
results = []
for file, values in files:
    config = roslaunch.config.ROSLaunchConfig()
    loader = roslaunch.xmlloader.XmlLoader()
    loader.ignore_unset_args = False
    printed = io.StringIO()
    try:
        with contextlib.redirect_stderr(printed):
            loader.load(file, config, argv=["roslaunch", *values], verbose=False)
        config.assign_machines()
    except Exception as error:
        results.append(None)
        continue
    results.append({
        "nodes": [
            [n.package, n.type, n.name, n.namespace.rstrip("/") or "/", n.args,
             n.output == "screen", n.respawn, n.respawn_delay, n.required,
             n.launch_prefix or "", [list(r) for r in n.remap_args], dict(n.env_args)]
            for n in config.nodes
        ],
        "tests": [[t.name, t.namespace.rstrip("/") or "/"] for t in config.tests],
        "parameters": {name: p.value for name, p in config.params.items()},
        "cleared": [name.rstrip("/") or "/" for name in config.clear_params],
        "warnings": len(config.config_errors) + printed.getvalue().count("WARN"),
        "steps": [[e.args[0], e.args[-1].rstrip("/") or "/"] for e in config.executables],
    })
print(json.dumps(results))
"""

NODE = '<node pkg="p" type="t" name="{}"/>'
INCLUDED = """<launch>
  <arg name="a"/> <arg name="b" default="two"/>
  <param name="~private" value="$(arg a)"/>
  <param name="shared" value="$(arg a)-$(arg b)"/>
  <remap from="inner" to="outer"/>
  <node pkg="p" type="t" name="included" args="$(arg b) $(anon x)"/>
</launch>"""
FOLDER = "FOLDER"

TEXTS = [
    '<node pkg="p" type="t" name="n" args="a  \'b c\'" output="screen" launch-prefix="xterm -e"/>',
    '<node pkg="p" type="t" name="n" respawn="True" respawn_delay="2" ns="/a//b/"/>',
    '<node pkg="p" type="t" name="n" required="TRUE" clear_params="true" ns="x"/>',
    '<node pkg="p" type="t" name="$(anon n)" args="$(anon n) $(anon m)"/>',
    '<node pkg="p" type="t" name="n" respawn="true" required="true"/>',
    '<node pkg="p" type="t" name="a/b"/>',
    '<node pkg="p" type="t"/>',
    '<node type="t" name="n"/>',
    '<node pkg="p" type="t" name="n" output="x"/>',
    '<node pkg="p" type="t" name="n" ns=""/>',
    NODE.format("n") * 2,
    '<test pkg="p" type="t" test-name="x" time-limit="3" ns="q"/>' + NODE.format("n"),
    '<param name="a" value=" 1 "/><param name="b" value="1e3"/><param name="c" value="1_0"/>'
    '<param name="d" value="TRUE"/><param name="e" value="1.50"/><param name="f" value="0x1"/>'
    '<param name="g" value=""/><param name="h" value="1_0.5"/><param name="i" value="no"/>',
    '<param name="a" value="1" type="str"/><param name="b" value="1" type="double"/>'
    '<param name="c" value="1" type="bool"/><param name="d" value="[1, {a: b}]" type="yaml"/>',
    '<param name="a" value="x" type="int"/>',
    '<param name="a" value="yes" type="bool"/>',
    '<param name="a" value="1" type="float"/>',
    '<param name="a"/>',
    '<param name="a" value="1" textfile="x"/>',
    '<param name="t" textfile="FOLDER/t.txt"/><param name="c" command="echo \'a b\' 12"/>'
    '<param name="i" command="echo 12"/>',
    '<param name="t" textfile="FOLDER/nope"/>',
    '<param name="c" command="false"/>',
    '<group ns="g"><param name="a//b/" value="1"/><param name="/c" value="2"/>'
    '<param name="~d" value="3"/>' + NODE.format("n") + "</group>" + NODE.format("m"),
    '<node pkg="p" type="t" name="n" ns="x"><param name="a" value="1"/><param name="~b" value="2"/>'
    '<param name="/c" value="3"/><rosparam>d: {e: 1}</rosparam>'
    '<rosparam param="/f">[1]</rosparam><rosparam ns="g" param="h">i</rosparam></node>',
    '<param name="~a" value="1"/>' + NODE.format("n") + '<param name="~a" value="2"/>'
    '<node pkg="p" type="t" name="m"><param name="a" value="3"/></node>',
    "<rosparam>a: 1\nb: {c: deg(180), d: [true, 'x']}\ne: {}\n</rosparam><rosparam/>",
    '<rosparam param="a">{b: 1}</rosparam><rosparam ns="c">d: 1</rosparam>'
    '<rosparam param="/e">1</rosparam><rosparam file="FOLDER/f.yaml" subst_value="true" ns="q"/>',
    "<rosparam>[1]</rosparam>",
    "<rosparam>a: [</rosparam>",
    '<rosparam command="x"/>',
    '<group ns="g"><rosparam command="delete" param="a"/>'
    '<rosparam command="dump" file="FOLDER/d" /><rosparam command="delete"/></group>',
    '<remap from="a" to="b"/><group><remap from="a" to="c"/><remap from="/d//e" to="f/"/>'
    + NODE.format("n")
    + '<remap from="x" to="y"/></group><node pkg="p" type="t" name="m"><remap from="a" to="z"/>'
    '<remap from="k" to="l"/></node>' + NODE.format("o"),
    '<remap from="a" to=""/>',
    '<remap from="a b" to="c"/>',
    '<env name="A" value="1"/><group><env name="A" value="2"/><env name="B" value=""/>'
    + NODE.format("n")
    + '</group><node pkg="p" type="t" name="m"><env name="C" value="$(env HOME)"/></node>',
    '<env name="" value="1"/>',
    '<arg name="a" default="1"/><arg name="b" value="$(arg a)2"/><param name="p" value="$(arg b)"/>'
    '<group><arg name="c" value="x"/><param name="q" value="$(arg c)$(arg given)"/></group>',
    '<arg name="given" default="1"/><param name="p" value="$(arg given)"/>',
    '<arg name="given" value="1"/>',
    '<arg name="a" value="1" default="2"/>',
    '<arg name="a"/><arg name="a"/>',
    '<arg name="a"/><param name="p" value="$(arg a)"/>',
    '<param name="p" value="$(arg nope)"/>',
    '<param name="p" value="$(nope)"/>',
    '<param name="p" value="$(env NOT_THERE)"/>',
    '<param name="p" value="$(optenv NOT_THERE a b)|$(optenv HOME x)"/>',
    '<param name="p" value="$(dirname)/x"/>',
    '<arg name="n" value="3"/><arg name="s" value="a,b"/><param name="p" value="$(eval n * 2)"/>'
    "<param name=\"q\" value=\"$(eval arg('s').split(',')[1] + str(n))\"/>"
    '<param name="r" value="$(eval n > 2 and s != \'x\')"/>'
    '<param name="t" value="$(eval round(n / 2.0))"/>',
    '<param name="p" value="$(eval sqrt(4) + pi * 0 + 7 // 2)"/>'
    '<param name="q" value="$(eval \'yes\' if true else [1])"/>'
    '<param name="r" value="$(eval \',\'.join(map(str, [1, 2.5])))"/>'
    "<param name=\"s\" value=\"$(eval env('HOME') + optenv('NOT_THERE', 'x') + anon('y'))\"/>",
    '<param name="p" value="x $(eval 1)"/>',
    '<param name="p" value="$(eval __import__(\'os\'))"/>',
    '<group if="1"><param name="p" value="1" unless="true"/><param name="q" value="1" if="TRUE"/>'
    '</group><group if="false"><nonsense/></group>',
    '<group if="yes"/>',
    '<group if="1" unless="0"/>',
    '<group ns="a" clear_params="true"><group ns="b">' + NODE.format("n") + "</group></group>",
    '<group clear_params="true"/>',
    '<remap from="x" to="y"/><include file="FOLDER/one.launch" ns="sub" clear_params="true">'
    '<arg name="a" value="$(arg given)"/><env name="E" value="1"/></include>' + NODE.format("n"),
    '<include file="FOLDER/one.launch"><arg name="a" value="1"/><arg name="b" default="d"/>'
    "</include>",
    '<include file="FOLDER/one.launch"/>',
    '<include file="FOLDER/one.launch"><arg name="a" value="1"/><arg name="zz" value="1"/>'
    "</include>",
    '<include file="FOLDER/one.launch"><arg name="a"/></include>',
    '<arg name="a" value="7"/><arg name="zz" value="7"/>'
    '<include file="FOLDER/one.launch" pass_all_args="true"/>',
    '<arg name="a" value="7"/><include file="FOLDER/one.launch" pass_all_args="true">'
    '<arg name="a" value="8"/></include><param name="after" value="$(arg a)"/>',
    '<include file="FOLDER/nope.launch"/>',
    "<!-- nothing -->",
    '<node pkg="p" type="t" name="n" foo="x"><bar/></node><sphinxdoc>x</sphinxdoc>',
    '<param name="p" value="1" vlaue="2"/><group nss="a">' + NODE.format("n") + "</group>",
    '<include file="FOLDER/one.launch" n="1"><arg name="a" value="1"/><param/></include>',
    '<machine name="m" address="localhost" timeout="10" ssh-port="22" default="TRUE"/>'
    + NODE.format("n"),
    '<machine name="m" address="localhost" timeout="0"/>',
    '<machine name="m" address="localhost" timeout=""/>',
    '<machine name="m" address="localhost" timeout="x"/>',
    '<machine name="m" address="localhost" timeout="1.5" env-loader="$(env HOME)/e"/>',
    '<machine name="m" address="localhost" ssh-port="x"/>',
    '<machine name="m" address="localhost" ssh-port=""/>',
    '<machine name="m" address="localhost" default="x"/>',
    '<machine name="m" address="localhost" default=""/>',
    '<machine name="m" address="localhost" ros-root="/x"/>',
    '<machine name="m" address="localhost" ros-root=""/>',
    '<machine name="m" address="localhost"><env name="A" value="1"/></machine>',
    '<machine name="m" address="localhost"><other/></machine>',
    '<machine name="m"/>',
    '<machine name="m" address="localhost" user="$(arg nope)"/>',
    '<machine name="m" address="localhost"/><machine name="m" address="localhost"/>',
    '<machine name="m" address="localhost"/><machine name="m" address="127.0.0.1"/>',
    '<node pkg="p" type="t" name="n" machine="nope"/>',
    '<node pkg="p" type="t" name="n" machine="m"/><machine name="m" address="localhost"/>',
    '<node pkg="p" type="t" name="n" machine=""/>',
    '<rosparam file=""/>',
    '<rosparam file="">a: 1</rosparam>',
    '<rosparam command="delete" file=""/>',
    '<rosparam command="">a: 1</rosparam>',
    '<rosparam command="load" ns="">a: 1</rosparam>',
    '<rosparam param="">a: 1</rosparam>',
    '<rosparam subst_value="">a: 1</rosparam>',
    '<rosparam subst_value="x">a: 1</rosparam>',
    '<node pkg="p" type="t" name="n"><Param name="a" value="1"/><REMAP from="a" to="b"/></node>',
    '<Node pkg="p" type="t" name="n"/>',
    '<node pkg="" type="" name="n"/>',
    '<node pkg="p" type="t" name="n" output=""/>',
    '<node pkg="p" type="t" name="n" respawn=""/>',
    '<node pkg="p" type="t" name="n" respawn_delay=""/>',
    '<node pkg="p" type="t" name="n" required="x"/>',
    '<node pkg="p" type="t" name="n" cwd="x"/>',
    '<node pkg="p" type="t" name="n" cwd="ROS_home"/>',
    '<node pkg="p" type="t" name="n" cwd=""/>',
    '<node pkg="p" type="t" name="n" clear_params=""/>',
    '<node pkg="p" type="t" name="n" clear_params="x"/>',
    '<node pkg="p" type="t" name="n" launch-prefix=""/>',
    '<node pkg="p" type="t" name="n" output="screen" if=""/>',
    '<node pkg="p" type="t" name="n"><test/></node>',
    '<group ns=""/>',
    '<group ns="a"><arg/></group>',
    '<group clear_params=""/>',
    '<include file=""/>',
    '<param name="a" value="1" type=""/>',
    '<param name="a" value=""/>',
    '<param name="a" textfile=""/>',
    '<param name="a b" value="1"/>',
    '<param name="a" value="1"><x/></param>',
    '<arg name="x" default=""/><param name="p" value="$(arg x)"/>',
    '<env name="A"/>',
    '<remap from="a"/>',
    '<test pkg="p" type="t" test-name="x" time-limit="0"/>',
    '<test pkg="p" type="t" test-name="x" time-limit=""/>',
    '<test pkg="p" type="t" test-name="x" retry="1.5"/>',
    '<test pkg="p" type="t" test-name="x" retry="-1"/>',
    '<test pkg="p" type="t" test-name="x" respawn="true"/>',
    '<test pkg="p" type="t"/>',
    '<master auto="start"/>',
    '<include file="FOLDER/one.launch"><Arg name="a" value="1"/></include>',
    '<include file="FOLDER/one.launch"><arg name="a" value="1"/><node/></include>',
    '<group ns="a" foo="1"><bar/></group>',
]
VALUES = ["given:=G"]


class RealRoslaunch:
    """What ROS's roslaunch reads in each of these files.

    Args:
        folder: the folder of the files.
    """

    def __init__(self, folder: Path) -> None:
        files = [[str(folder / f"{number}.launch"), VALUES] for number in range(len(TEXTS))]
        done = subprocess.run(
            ["/usr/bin/python3", "-c", SCRIPT, json.dumps(files)],
            capture_output=True,
            text=True,
            env={
                "PATH": os.environ["PATH"],
                "HOME": "/home/me",
                "ROS_MASTER_URI": "http://localhost:1",
            },
            check=True,
        )
        read = done.stdout.splitlines()[-1].replace(str(folder), FOLDER)
        self.results: list[Any] = json.loads(read)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of all files."""
    folder = tmp_path_factory.mktemp("launch")
    (folder / "one.launch").write_text(INCLUDED)
    (folder / "t.txt").write_text("some text\n")
    (folder / "f.yaml").write_text("home: $(env HOME)\n")
    for number, text in enumerate(TEXTS):
        file = folder / f"{number}.launch"
        file.write_text(f"<launch>{text.replace(FOLDER, str(folder))}</launch>")
    return folder


@pytest.fixture(scope="module")
def real_roslaunch(folder: Path) -> RealRoslaunch:
    """ROS's roslaunch, needed for recording only."""
    return RealRoslaunch(folder)


class Real(FakeEnvironment):
    """A fake environment with real files and commands."""

    def read(self, file: str) -> bytes:
        return Path(file).read_bytes()

    def output(self, command: str) -> str:
        return subprocess.run(command, shell=True, capture_output=True, check=True).stdout.decode()

    def yaml(self, text: str) -> Any:
        try:
            return yaml.safe_load(text.replace("deg(180)", "3.141592653589793"))
        except yaml.YAMLError as error:
            raise ValueError(str(error)) from None


def read(file: Path) -> Any:
    """Return what fibws reads in a file as `RealRoslaunch` has it; None if it is refused."""
    reader = LaunchReader(Real(), {"given": "G"})
    try:
        reader.read(str(file))
    except (ValueError, subprocess.CalledProcessError):
        return None
    launch = reader.launch
    nodes = [node for node in launch.nodes.values() if not node.is_test]
    found = {
        "nodes": [
            [
                *(node.package, node.type, node.name, node.namespace, node.args),
                *(node.screen, node.respawn, node.respawn_delay, node.required, node.prefix),
                [list(remap) for remap in node.remaps],
                dict(node.environment),
            ]
            for node in nodes
        ],
        "tests": [[node.name, node.namespace] for node in launch.nodes.values() if node.is_test],
        "parameters": launch.parameters,
        "cleared": launch.cleared,
        "warnings": len(launch.warnings),
        "steps": [[step.command, step.name] for step in launch.steps],
    }
    return json.loads(json.dumps(found).replace(str(file.parent), FOLDER))


@pytest.mark.parametrize("number", range(len(TEXTS)), ids=TEXTS)
def test_result_is_that_of_roslaunch(
    number: int, folder: Path, answers: Answers, request: pytest.FixtureRequest
) -> None:
    expected = answers.of(
        TEXTS[number], lambda: request.getfixturevalue("real_roslaunch").results[number]
    )
    assert read(folder / f"{number}.launch") == expected
