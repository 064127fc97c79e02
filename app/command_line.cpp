// SPDX-License-Identifier: BSD-3-Clause
#include "command_line.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>
#include <type_traits>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "roughmesh/report.hpp"

namespace roughmesh::app {
namespace {

const std::string exit_codes =
    "Exit codes: 0 done, 1 a check failed, 2 usage or input, 3 file format, 4 numerical, 130 "
    "interrupt.";

/// "--length-definition" from "length_definition"; files stand without dashes, OUTPUT also as -o.
std::string flag_of(const OptionText& text) {
  if (text.name == "input") return "INPUT";
  if (text.name == "output") return "-o,--output";
  std::string flag = "--" + std::string(text.name);
  std::replace(flag.begin(), flag.end(), '_', '-');
  return flag;
}

template <class Enum>
std::string listed_choices() {
  std::string names;
  for (const Enum choice : Choices<Enum>::values)
    names += fmt::format("{}{}", names.empty() ? "" : ", ", name(choice));
  return names;
}

/// The whole text as a number, in base 10.
template <class Number>
Number parse_number(std::string_view text, const std::string& flag) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error == std::errc() && end == text.data() + text.size()) return number;
  const char* const wanted =
      std::is_floating_point_v<Number> ? "a number" : "a whole number from 0 on";
  throw InputError(fmt::format("{}: {}; must be {}", flag, text, wanted));
}

std::vector<double> parse_list(std::string_view text, const std::string& flag) {
  std::vector<double> numbers;
  for (std::size_t comma = text.find(','); comma != text.npos; comma = text.find(',')) {
    numbers.push_back(parse_number<double>(text.substr(0, comma), flag));
    text.remove_prefix(comma + 1);
  }
  numbers.push_back(parse_number<double>(text, flag));
  return numbers;
}

template <class Enum>
Enum parse_choice(std::string_view text, const std::string& flag) {
  for (const Enum choice : Choices<Enum>::values)
    if (text == name(choice)) return choice;
  throw InputError(fmt::format("{}: {}; must be one of {}", flag, text, listed_choices<Enum>()));
}

/// The value of an optional member, void of any other.
template <class Member>
struct ValueOf {
  using type = void;
};
template <class Value>
struct ValueOf<std::optional<Value>> {
  using type = Value;
};
template <class Member>
constexpr bool is_optional = !std::is_void_v<typename ValueOf<Member>::type>;

template <class Member>
void parse_into(Member& member, const std::string& text, const std::string& flag) {
  if constexpr (is_optional<Member>)
    parse_into(member.emplace(), text, flag);
  else if constexpr (std::is_enum_v<Member>)
    member = parse_choice<Member>(text, flag);
  else if constexpr (std::is_same_v<Member, std::vector<double>>)
    member = parse_list(text, flag);
  else if constexpr (std::is_arithmetic_v<Member>)
    member = parse_number<Member>(text, flag);
  else
    member = text;
}

/// The help of an option, with its choices and default.
template <class Member>
std::string described(const OptionText& text, const Member& member) {
  if constexpr (is_optional<Member> && std::is_enum_v<typename ValueOf<Member>::type>)
    return fmt::format("{}: {}", text.help, listed_choices<typename ValueOf<Member>::type>());
  else if constexpr (std::is_enum_v<Member>)
    return fmt::format("{}: {}; default {}", text.help, listed_choices<Member>(), name(member));
  else if constexpr (std::is_arithmetic_v<Member>)
    return text.name == "rms" ? std::string(text.help)
                              : fmt::format("{}; default {}", text.help, member);
  else
    return std::string(text.help);
}

template <class Member>
CLI::Option* add_option(CLI::App& app, const OptionText& text, Member& member) {
  const std::string flag = flag_of(text);
  if constexpr (std::is_same_v<Member, bool>)
    return app.add_flag(flag, member, std::string(text.help));
  else if constexpr (std::is_same_v<Member, std::vector<std::string>>)
    return app.add_option(flag, member, std::string(text.help))->expected(1)->take_all();
  else
    return app.add_option_function<std::string>(
        flag, [&member, flag](const std::string& given) { parse_into(member, given, flag); },
        described(text, member));
}

/// `--group --rms 2` forgot the name; without this the parser takes "--rms" for it.
std::string refuse_option_as_value(const std::string& given) {
  return given.starts_with("--") ? "needs a value, not " + given : "";
}

/// Options that only job files can hold.
template <class Member>
constexpr bool is_for_jobs =
    std::is_same_v<Member, std::vector<Mask>> || std::is_same_v<Member, std::vector<Vec3>>;

/// Adds options to a verb; `only` names the ones that it takes, all if empty.
class OptionAdder {
 public:
  OptionAdder(CLI::App& app, std::vector<std::string_view> only)
      : app_(&app), only_(std::move(only)) {}

  template <class Member>
  void operator()(const OptionText& text, Member& member) {
    if constexpr (!is_for_jobs<Member>) add(text, member);
  }

  std::vector<CLI::Option*> added;

 private:
  template <class Member>
  void add(const OptionText& text, Member& member) {
    if (!only_.empty() && std::find(only_.begin(), only_.end(), text.name) == only_.end()) return;
    CLI::Option* option = add_option(*app_, text, member);
    if (text.name != "input") option->type_name(std::string(text.value));
    if (!std::is_same_v<Member, bool>) option->check(refuse_option_as_value);
    added.push_back(option);
  }

  CLI::App* app_;
  std::vector<std::string_view> only_;
};

/// @return  those that describe a surface
std::vector<CLI::Option*> add_options(CLI::App& app, RoughenOptions& options,
                                      const std::vector<std::string_view>& only = {}) {
  OptionAdder of_run(app, only), of_surface(app, only);
  for_each_run_option(options, of_run);
  for_each_surface_option(options.surfaces.front(), of_surface);
  for (CLI::Option* option : of_surface.added) option->group("Surface");
  return of_surface.added;
}

/// The parser for one pass over the arguments; writes into `command`.
struct Parser {
  explicit Parser(Command& command) {
    app.name("roughmesh");
    app.footer(exit_codes +
               "\n`roughmesh roughen --help` and `roughmesh info --help` list the options.");
    app.require_subcommand(0, 1);
    app.add_flag("--version", show_version, "print the version");

    roughen = app.add_subcommand("roughen", "make rough meshes from a smooth one");
    of_surface = add_options(*roughen, command.options);
    roughen
        ->add_option(
            "--job", job,
            "take options from a TOML file or from the report of an earlier run; options given "
            "here override it")
        ->type_name("FILE");
    roughen->footer(exit_codes);

    info =
        app.add_subcommand("info", "list groups and sizes, and what roughness the mesh can carry");
    add_options(
        *info, command.options,
        {"input", "group",      "rms",          "length",    "acf",       "length_definition",
         "nu",    "hurst",      "rolloff",      "power",     "alpha",     "table",
         "angle", "cutoff",     "method",       "tolerance", "distance",  "period",
         "edges", "edge_angle", "flip",         "unit",      "mesh_size", "round",
         "gmsh",  "timeout",    "trust_scripts"});
    info->footer(exit_codes);
  }

  CLI::App app{
      "Makes finite element meshes rough, with statistics that are asked for and certified."};
  CLI::App* roughen = nullptr;
  CLI::App* info = nullptr;
  std::vector<CLI::Option*> of_surface;  ///< options of roughen that describe a surface
  std::string job;
  bool show_version = false;
};

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

/// Arguments that no option took: the first one that looks like an option is the culprit.
[[noreturn]] void refuse_extras(const Parser& parser) {
  const std::vector<std::string> extras = parser.app.remaining(true);
  const auto option = std::find_if(extras.begin(), extras.end(),
                                   [](const std::string& each) { return each.starts_with("-"); });
  const bool has_verb = *parser.roughen || *parser.info;
  const std::string verb = *parser.info ? "info" : "roughen";
  throw InputError(
      fmt::format("{}: {}", option != extras.end() ? *option : extras.front(),
                  has_verb ? "no option of this verb, or one argument too many; `roughmesh " +
                                 verb + " --help` lists the options"
                           : "unknown; the verbs are roughen and info"));
}

/// CLI11 takes its arguments last first.
void parse(Parser& parser, std::vector<std::string> arguments) {
  std::reverse(arguments.begin(), arguments.end());
  try {
    parser.app.parse(std::move(arguments));
  } catch (const CLI::CallForHelp&) {
    throw;
  } catch (const CLI::ExtrasError&) {
    refuse_extras(parser);
  } catch (const CLI::ParseError& error) {
    throw InputError(one_line(error.what()) + "; `roughmesh --help` shows the usage");
  }
}

/// Which of several surfaces would such an option mean?
void refuse_surface_options(const Parser& parser, const RoughenOptions& job) {
  if (job.surfaces.size() < 2) return;
  for (const CLI::Option* option : parser.of_surface)
    if (option->count() > 0)
      throw InputError(fmt::format("{}: the job has {} surfaces; set it in their tables",
                                   option->get_name(), job.surfaces.size()));
}

}  // namespace

Command parse_command_line(const std::vector<std::string>& arguments) {
  Command command;
  Parser first(command);
  try {
    parse(first, arguments);
  } catch (const CLI::CallForHelp&) {
    command.text = first.app.help();
    return command;
  }
  if (first.show_version) return {Verb::version, {}, false, "roughmesh " + version() + "\n"};
  if (*first.info) {
    command.verb = Verb::info;
    command.has_rms = first.info->count("--rms") > 0;
  } else if (*first.roughen) {
    command.verb = Verb::roughen;
    if (!first.job.empty()) {
      // A second pass over the same arguments, on top of what the job says.
      command.options = read_job(first.job);
      refuse_surface_options(first, command.options);
      Parser second(command);
      parse(second, arguments);
    }
  } else {
    command.text = first.app.help();
  }
  return command;
}

}  // namespace roughmesh::app
