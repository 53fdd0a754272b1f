#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <string>

#include "cli/commands.h"
#include "cli/completion.h"
#include "cli/described.h"
#include "cli/man_page.h"
#include "core/file.h"

namespace clipgs {

namespace {

void write_pages(const CLI::App& app, const std::filesystem::path& folder) {
  create_folder(folder);
  const DescribedCommand program = describe(app);
  const std::vector<DescribedCommand> commands = describe_commands(app);
  write_text(folder / (program.name + ".1"), program_page(program, commands));
  for (const DescribedCommand& command : commands) {
    write_text(folder / fmt::format("{}-{}.1", program.name, command.name),
               command_page(program, command));
  }
}

void print_completion(const CLI::App& app, const std::string& shell) {
  const DescribedCommand program = describe(app);
  const std::vector<DescribedCommand> commands = describe_commands(app);
  const auto complete = shell == "bash"  ? bash_completion
                        : shell == "zsh" ? zsh_completion
                                         : fish_completion;
  fmt::print("{}", complete(program, commands));
}

}  // namespace

void add_man_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("man", "Write the manual pages of all commands");
  const auto folder = std::make_shared<std::string>();
  command
      ->add_option("-o,--output", *folder, "Folder to write them into: clipgs.1 and one a command")
      ->required();
  command->footer(
      "Example: clipgs man -o pages && man pages/clipgs-build.1\n"
      "         clipgs man -o ~/.local/share/man/man1");
  command->callback([&app, folder] { write_pages(app, *folder); });
}

void add_completion_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "completion", "Print what completes commands and options in a shell by Tab");
  const auto shell = std::make_shared<std::string>();
  command->add_option("shell", *shell, "bash, zsh or fish")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  command->footer(
      "Example: source <(clipgs completion bash)\n"
      "         clipgs completion fish > ~/.config/fish/completions/clipgs.fish");
  command->callback([&app, shell] { print_completion(app, *shell); });
}

}  // namespace clipgs
