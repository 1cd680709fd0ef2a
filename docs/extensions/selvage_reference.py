"""Directives that fill the reference of the site with what the sources themselves say.

program-help   the help of the program, command by command, as it prints it
cpp-headers    the public C++ names, header by header, with links to the pages of Doxygen
scene-schema   the members that the reader of scenes asks for, with the values that it accepts
"""

import pathlib
import re
import subprocess
import xml.etree.ElementTree as ElementTree

from docutils import nodes
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

logger = logging.getLogger(__name__)


def section(title, *content):
    result = nodes.section(ids=[nodes.make_id(title)], names=[nodes.fully_normalize_name(title)])
    result += nodes.title(text=title)
    result += content
    return result


def table(titles, rows):
    """@param rows  lists of nodes or texts; texts stand as code"""
    group = nodes.tgroup(cols=len(titles))
    group += [nodes.colspec(colwidth=1) for _ in titles]

    def row(cells):
        result = nodes.row()
        for cell in cells:
            entry = nodes.entry()
            entry += cell if isinstance(cell, nodes.Node) else nodes.paragraph("", "", nodes.literal(text=cell))
            result += entry
        return result

    head, body = nodes.thead(), nodes.tbody()
    head += row([nodes.paragraph(text=title) for title in titles])
    body += [row(cells) for cells in rows]
    group += [head, body]
    result = nodes.table()
    result += group
    return result


class ProgramHelp(SphinxDirective):
    """Runs `selvage --help`, and `selvage COMMAND --help` for each command that it lists."""

    def run(self):
        program = self.config.selvage_program
        if not pathlib.Path(program).exists():
            raise self.error(f"{program} is not there: build it first, with `make python`")

        def text(*arguments):
            return subprocess.run([program, *arguments, "--help"], check=True, capture_output=True, text=True).stdout

        whole = text()
        listed = whole.split("Subcommands:" if "Subcommands:" in whole else "Commands:")[1]
        commands = re.findall(r"^  (\w[\w-]*) ", listed, re.MULTILINE)
        if not commands:
            raise self.error("the help of the program lists no commands")
        return [nodes.literal_block(whole, whole, language="text"),
                *(section(f"selvage {command}", nodes.literal_block(text(command), text(command), language="text"))
                  for command in commands)]


def from_here(directive, page):
    """Address of a page of the site, seen from the one that holds the directive."""
    return "../" * directive.env.docname.count("/") + page


def link(text, address):
    return nodes.reference("", "", nodes.literal(text=text), refuri=address, internal=True)


class CppHeaders(SphinxDirective):
    """Reads the tag file of Doxygen: the classes and functions of each header."""

    def run(self):
        tags = pathlib.Path(self.config.selvage_tags)
        if not tags.exists():
            raise self.error(f"{tags} is not there: run doxygen first, as `make docs` does")
        self.env.note_dependency(str(tags))
        root = ElementTree.parse(tags).getroot()
        pages = {compound.findtext("name"): compound.findtext("filename") for compound in root.iter("compound")}
        folders = {}
        for compound in root.iter("compound"):
            if compound.get("kind") != "file" or not compound.findtext("name").endswith(".h"):
                continue
            folder = re.search(r"include/(selvage/.*)", compound.findtext("path"))[1]
            names = {}
            for name in (node.text for node in compound.findall("class") if node.text):
                if name.count("::") == 1 and name in pages:
                    names[name.removeprefix("selvage::")] = pages[name]
            for member in compound.findall("member"):
                if member.get("kind") in ("function", "typedef", "enumeration", "variable"):
                    page = f"{member.findtext('anchorfile')}#{member.findtext('anchor')}"
                    names.setdefault(member.findtext("name") + "()" * (member.get("kind") == "function"), page)
            if not names:  # it includes others
                continue
            header = link(folder + compound.findtext("name"), from_here(self, "cpp/" + compound.findtext("filename")))
            links = nodes.paragraph()
            for name, page in names.items():
                links += [nodes.Text(", "), link(name, from_here(self, "cpp/" + page))]
            del links[0]
            folders.setdefault(folder.strip("/").removeprefix("selvage/"), []).append(
                [nodes.paragraph("", "", header), links])
        if not folders:
            raise self.error(f"{tags} names no headers")
        return [section(folder, table(["header", "holds"], rows)) for folder, rows in sorted(folders.items())]


# A member that is asked for, with the name that its value gets where it gets one.
MEMBER = re.compile(r'(?:(\w+) = )?(?:\w+\.(find|get)\(|find_of_solver\(\w+, )"(\w+)"[^)]*\)')
ONE_OF = re.compile(r"get_one_of\((\w+)\)")
RANGES = {"kPositive": " above 0", "kNotNegative": " from 0"}
FORMS = {"any_number": "a number", "boolean": "true or false", "text": "text", "vector": "[x, y, z]",
         "direction": "[x, y, z], of any length but 0", "items": "a list"}


def allowed(call, arguments, arrays):
    """The values that a call of the reader accepts, in words.

    @param arrays  names in the order of the constants that hold them
    """
    if call == "choice":
        return "one of " + ", ".join(arrays[arguments]) if arguments in arrays else "a name that `selvage make` knows"
    if call in ("number", "integer"):
        kind = "a number" if call == "number" else "a whole number"
        if arguments in RANGES:
            return kind + RANGES[arguments]
        if arguments == "1, 1":
            return "1"
        least, most = re.sub(r"std::int64_t\{1\} << 29", "2^29", arguments).strip("{}").split(", ")
        return f"{kind} from {least} to {most}".replace("'", ",").replace("kMaxInstances", "100,000")
    return FORMS.get(call) or re.sub("^(read|find)_", "", call).replace("_", " ")


class SceneSchema(SphinxDirective):
    """Reads the reader of scenes: every member that it asks an object for, and by which call it takes the value.

    The guide to scene files has to name each of them: one that it does not name is a warning, which stops the build.
    """

    def run(self):
        guide = pathlib.Path(self.config.selvage_scene_guide).read_text()
        result = []
        files = sorted(pathlib.Path(self.config.selvage_scene_reader).glob("scene_*.cpp"), reverse=True)
        # From one function to the next, as clang-format lays them out: its name stands in an unindented line. The last
        # function of a file is the one that calls the others.
        functions = {file: list(reversed(re.split(r"\n(?=\w[^;\n]*\()", file.read_text()))) for file in files}
        for file in files:
            self.env.note_dependency(str(file))
            text = file.read_text()
            found = 0
            for function in functions[file]:
                members = self.members(function, text)
                if not members:
                    continue
                found += len(members) - sum(needed.startswith("one of") for _, needed, _ in members)
                name = re.search(r"\w+(?=\()", function)[0]
                title = self.title(name)
                if "JsonObject& " in function.split(")")[0]:  # it reads on in the object of its caller
                    callers = [self.title(re.search(r"\w+(?=\()", other)[0]) for others in functions.values()
                               for other in others if re.search(rf"\n .*\b{name}\(", other)]
                    title += ", in " + ", ".join(dict.fromkeys(callers))
                rows = [[member, nodes.paragraph(text=needed), nodes.paragraph(text=value)]
                        for member, needed, value in members]
                result.append(section(title, table(["member", "", "value"], rows)))
                for member, _, _ in members:
                    if f"`{member}`" not in guide and f'"{member}"' not in guide:
                        logger.warning("%s reads '%s', which %s does not name", file.name, member,
                                       self.config.selvage_scene_guide)
            asked = len(re.findall(r'(?:find|get)\("|find_of_solver\(\w+, "', text)) + sum(
                names.count(",") + 1 for names in re.findall(r"const char\* key : \{([^}]*)\}\)\s+if", text))
            if found != asked:
                logger.warning("%s asks for %d members, of which the schema shows %d", file.name, asked, found)
        if not result:
            raise self.error("the reader of scenes asks for nothing")
        return result

    @staticmethod
    def title(function):
        return re.sub("^(read|describe)_", "", function).replace("_", " ")

    @staticmethod
    def members(function, text):
        """Name, whether it must be there, and accepted values of each member that a function asks for."""
        arrays = {name: re.findall(r'"([^"]*)"', names)
                  for name, names in re.findall(r'(k\w+)\{((?:\s*"[^"]*",?)+)\}', text + function)}
        result = []
        for match in MEMBER.finditer(function):
            variable, how, member = match[1], match[2], match[3]
            # The value is used up to the next that gets the same name.
            again = re.search(rf"(?:auto|,) {variable} = ", function[match.end():])
            after = function[match.end():match.end() + again.start() if again else len(function)]
            call = re.match(r"\.(\w+)\(([^)]*)\)", after)
            if not call and variable:
                call = (re.search(rf"\b{variable}->(?!json|fail|member)(\w+)\(([^)]*)\)", after)
                        or re.search(rf"\b{variable}\.(?!json|fail|member)(\w+)\(([^)]*)\)", after)
                        or re.search(rf"(read_\w+|find_material|jitter)\((\*{variable})\b", after))
            call = call or re.search(r"(read_\w+)()\($", function[:match.start()])
            value = allowed(call[1], call[2], arrays) if call else "an object"
            result.append((member, "required" if how == "get" else "", value))
        loops = r"for \(const char\* key : \{([^}]*)\}\)\s+if \(const auto v = \w+\.find\(key\)\) v->(\w+)"
        for names, call in re.findall(loops, function):
            result += [(name, "", FORMS[call]) for name in re.findall(r'"([^"]*)"', names)]
        for match in ONE_OF.finditer(function):
            names = arrays[match[1]]
            result += [(name, "one of " + ", ".join(names), "an object" if name not in ("file", "shape") else "text")
                       for name in names]
        return result

def is_alias_of_a_field(app, what, name, member, skip, options):
    """The fields of a tuple stand in its docstring."""
    return True if str(getattr(member, "__doc__", "")).startswith("Alias for field number") else None


def setup(app):
    app.connect("autodoc-skip-member", is_alias_of_a_field)
    for name in ("program", "tags", "scene_reader", "scene_guide"):
        app.add_config_value(f"selvage_{name}", "", "env")
    app.add_directive("program-help", ProgramHelp)
    app.add_directive("cpp-headers", CppHeaders)
    app.add_directive("scene-schema", SceneSchema)
    return {"parallel_read_safe": True, "version": "1"}
