// Commands and their options: CLI11 behind a small interface, since its header takes 15 s to compile wherever
// it is included.
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace lumel {

// What is wrong with a command line, in one line.
struct UsageError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

class Option {
public:
    explicit Option(CLI::Option* option) : option_(option) {}
    std::string name() const;
    bool given() const;
    // As help shows it.
    Option& describe(const std::string& help);
    Option& byDefault(const std::string& text);
    Option& required();
    Option& environment(const char* variable); // read where the option is not given
    Option& needs(const Option& other);
    Option& excludes(const Option& other);

private:
    CLI::Option* option_;
};

class Command {
public:
    explicit Command(CLI::App* app);

    // An option (or an argument by its place: a name without dashes) that takes a value. `read` returns what
    // is wrong with the text, or nothing. `takes` says what the values are: "FILE", "0..1", "a|b|c".
    using Read = std::function<std::string(const std::string& text)>;
    Option add(const std::string& name, const std::string& takes, const std::string& help, Read read);
    // One that may be given several times, or takes `count` values at once.
    Option addRepeated(const std::string& name, const std::string& takes, const std::string& help, Read read);
    Option addSeveral(const std::string& name, int count, const std::string& takes, const std::string& help,
                      Read read);
    // Sets `value`; "!--no-x" clears it.
    Option addFlag(const std::string& name, const std::string& help, bool& value);

    Option get(const std::string& name) const;
    void remove(const std::string& name);
    std::vector<Option> given() const;
    // Called once all is read, in this order. May throw UsageError.
    void afterParsing(std::function<void()> check) { checks_->push_back(std::move(check)); }

private:
    Option finish(CLI::Option* option, const std::string& takes) const;
    CLI::App* app_;
    std::shared_ptr<std::vector<std::function<void()>>> checks_;
};

// The program's command line: commands, each with its options.
class CommandLine {
public:
    CommandLine(const std::string& name, const std::string& description, const std::string& version);
    ~CommandLine();
    Command add(const std::string& name, const std::string& description);
    // The command that was given; empty when help or the version was asked for, which is then printed. Throws
    // UsageError.
    std::string parse(const std::vector<std::string>& arguments);
    // Of a command, or of all. Throws UsageError when there is no such command.
    std::string help(const std::string& command = "") const;
    // The reference of all commands.
    std::string markdown() const;

private:
    std::unique_ptr<CLI::App> app_;
    std::string help_; // of all commands; CLI11 shows another one after parsing
};

} // namespace lumel
