// The only file that includes CLI11.
#include "option_parser.h"
#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace lumel {
namespace {

void readOrThrow(const std::string& name, const std::string& text, const Command::Read& read)
{
    if (const std::string wrong = read(text); !wrong.empty())
        throw UsageError(name + " " + text + ": " + wrong);
}

// "|" would end a cell of a table.
std::string cell(const std::string& text)
{
    std::string result;
    for (const char c : text)
        result += c == '|' ? "\\|" : std::string(1, c);
    return result;
}

std::string codeCell(const std::string& text)
{
    return text.empty() ? "" : "`" + cell(text) + "`";
}

std::string markdownOf(const CLI::App& command, const std::string& program)
{
    std::string usage = program + " " + command.get_name(), rows;
    for (const CLI::Option* option : command.get_options()) {
        const std::string name = option->get_name(option->get_positional(), true);
        if (option->get_name() == "--help")
            continue;
        if (option->get_positional())
            usage += option->get_required() ? " " + name : " [" + name + "]";
        const std::string env =
            option->get_envname().empty() ? "" : fmt::format(" (environment: `{}`)", option->get_envname());
        rows += fmt::format("| `{}` | {} | {} | {}{}{} |\n", name, codeCell(option->get_type_name()),
                            cell(option->get_default_str()), cell(option->get_description()), env,
                            option->get_required() ? "; required" : "");
    }
    std::string text =
        fmt::format("## {} {}\n\n{}.\n\n", program, command.get_name(), command.get_description());
    text += fmt::format("```\n{}{}\n```\n", usage, rows.empty() ? "" : " [OPTIONS]");
    if (!rows.empty())
        text += "\n| Option | Value | Default | Meaning |\n|---|---|---|---|\n" + rows;
    return text;
}

} // namespace

std::string Option::name() const
{
    return option_->get_name();
}

bool Option::given() const
{
    return option_->count() > 0;
}

Option& Option::describe(const std::string& help)
{
    option_->description(help);
    return *this;
}

Option& Option::byDefault(const std::string& text)
{
    option_->default_str(text);
    return *this;
}

Option& Option::required()
{
    option_->required();
    return *this;
}

Option& Option::environment(const char* variable)
{
    option_->envname(variable);
    return *this;
}

Option& Option::needs(const Option& other)
{
    option_->needs(other.option_);
    return *this;
}

Option& Option::excludes(const Option& other)
{
    option_->excludes(other.option_);
    return *this;
}

Command::Command(CLI::App* app) : app_(app), checks_(std::make_shared<std::vector<std::function<void()>>>())
{
    app->callback([checks = checks_] {
        for (const auto& check : *checks)
            check();
    });
}

Option Command::finish(CLI::Option* option, const std::string& takes) const
{
    option->type_name(takes);
    return Option(option);
}

Option Command::add(const std::string& name, const std::string& takes, const std::string& help, Read read)
{
    const std::string shown = name.substr(name.rfind(',') + 1);
    return finish(app_->add_option_function<std::string>(
                      name, [=](const std::string& text) { readOrThrow(shown, text, read); }, help),
                  takes);
}

Option Command::addRepeated(const std::string& name, const std::string& takes, const std::string& help,
                            Read read)
{
    CLI::Option* option = app_->add_option_function<std::vector<std::string>>(
        name,
        [=](const std::vector<std::string>& texts) {
            for (const std::string& text : texts)
                readOrThrow(name, text, read);
        },
        help);
    option->allow_extra_args(!name.starts_with("-")); // else an option would take the arguments that follow
    return finish(option, takes);
}

Option Command::addSeveral(const std::string& name, int count, const std::string& takes,
                           const std::string& help, Read read)
{
    Option option = addRepeated(name, takes, help, std::move(read));
    app_->get_option(name)->allow_extra_args()->expected(count);
    return option;
}

Option Command::addFlag(const std::string& name, const std::string& help, bool& value)
{
    return Option(app_->add_flag(name, value, help));
}

Option Command::get(const std::string& name) const
{
    return Option(app_->get_option(name));
}

void Command::remove(const std::string& name)
{
    app_->remove_option(app_->get_option(name));
}

std::vector<Option> Command::given() const
{
    std::vector<Option> options;
    for (CLI::Option* option : app_->get_options({}))
        if (option->count() > 0)
            options.emplace_back(option);
    return options;
}

CommandLine::CommandLine(const std::string& name, const std::string& description, const std::string& version)
    : app_(std::make_unique<CLI::App>(description, name))
{
    app_->require_subcommand(1);
    app_->get_formatter()->column_width(44);
    app_->set_version_flag("--version", version);
}

CommandLine::~CommandLine() = default;

Command CommandLine::add(const std::string& name, const std::string& description)
{
    return Command(app_->add_subcommand(name, description));
}

std::string CommandLine::parse(const std::vector<std::string>& arguments)
{
    help_ = app_->help();
    try {
        app_->parse(
            std::vector<std::string>(arguments.rbegin(), arguments.rend())); // CLI11 wants the last first
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() != 0)
            throw UsageError(e.what());
        app_->exit(e); // --help, --version
        return "";
    }
    return app_->get_subcommands().front()->get_name();
}

std::string CommandLine::help(const std::string& command) const
{
    if (command.empty())
        return help_;
    try {
        return app_->get_subcommand(command)->help(app_->get_name());
    } catch (const CLI::OptionNotFound&) {
        throw UsageError("help: no command " + command);
    }
}

std::string CommandLine::markdown() const
{
    std::string text =
        "# The commands of lumel\n\nWritten by `lumel help --markdown` from the options themselves: "
        "change these, not this file.\n`lumel help COMMAND` shows the same in the terminal. Names of "
        "files choose their format by extension.\n";
    for (const CLI::App* command : app_->get_subcommands({}))
        text += "\n" + markdownOf(*command, app_->get_name());
    return text;
}

} // namespace lumel
