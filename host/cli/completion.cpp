// raysteer completion: thin adaptors of three shells around `raysteer __complete`, which walks the command tree.
#include "host/cli/commands.hpp"

namespace raysteer::host::cli {
namespace {

constexpr const char* kBash = R"sh(# bash completion of raysteer; load with: eval "$(raysteer completion bash)"
_raysteer() {
  local current="${COMP_WORDS[COMP_CWORD]}" IFS=$'\n' lines
  lines=($(raysteer __complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null))
  case "${lines[0]}" in
    :files) compopt -o filenames; COMPREPLY=($(compgen -f -- "$current")) ;;
    :dirs) compopt -o filenames; COMPREPLY=($(compgen -d -- "$current")) ;;
    *) COMPREPLY=("${lines[@]%%$'\t'*}") ;;
  esac
}
complete -F _raysteer raysteer
)sh";

constexpr const char* kZsh = R"sh(#compdef raysteer
# zsh completion of raysteer; load with: eval "$(raysteer completion zsh)"
_raysteer() {
  local -a lines words_and_meanings
  local line
  lines=("${(@f)$(raysteer __complete "${(@)words[2,CURRENT]}" 2>/dev/null)}")
  case "$lines[1]" in
    :files) _files ;;
    :dirs) _files -/ ;;
    *)
      for line in $lines; do
        words_and_meanings+=("${${line%%$'\t'*}//:/\\:}:${line#*$'\t'}")
      done
      _describe raysteer words_and_meanings ;;
  esac
}
# Loaded as a file, zsh runs this once for the first completion; read by eval, it has to be made known.
if [[ "$funcstack[1]" = "_raysteer" ]]; then
  _raysteer "$@"
else
  compdef _raysteer raysteer
fi
)sh";

constexpr const char* kFish = R"sh(# fish completion of raysteer; load with: raysteer completion fish | source
function __raysteer_complete
  set -l words (commandline -opc) (commandline -ct)
  set -l lines (raysteer __complete $words[2..-1] 2>/dev/null)
  switch "$lines[1]"
    case :files
      __fish_complete_path (commandline -ct)
    case :dirs
      __fish_complete_directories (commandline -ct)
    case '*'
      printf '%s\n' $lines
  end
end
complete -c raysteer -f -a '(__raysteer_complete)'
)sh";

class Completion : public Command {
 public:
  Manual manual() const override {
    return {.summary = "Print a shell's completion script",
            .description = "Commands, options and their values complete with the tab key.",
            .example = "eval \"$(raysteer completion bash)\"\nraysteer completion fish | source",
            .has_json = false};
  }

  void declare(Options& options) override {
    options.argument("SHELL", &shell_, "bash, zsh or fish").choices({"bash", "zsh", "fish"});
  }

  Result<ExitCode> run(Context& context) override {
    context.print(shell_ == "bash" ? kBash : shell_ == "zsh" ? kZsh : kFish);
    return ExitCode::kDone;
  }

 private:
  std::string shell_;
};

}  // namespace

std::unique_ptr<Command> completion() { return std::make_unique<Completion>(); }

}  // namespace raysteer::host::cli
