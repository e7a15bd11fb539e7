// orbis: sphere parametrization and texturing of closed genus-0 meshes, as a service and on the command line.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <iostream>

#include "api/json.h"
#include "server/commands.h"
#include "server/job_child.h"

namespace {

using orbis::server::Config;

// Takes the command line's settings as text, so that they can go on top of the file's and the environment's.
using Flags = std::vector<std::pair<std::string, std::string>>;

void add_settings(CLI::App& command, Flags& flags) {
  const Config defaults;
  for (const auto& setting : orbis::server::settings()) {
    const std::string name(setting.name), fallback = setting.get(defaults);
    command
        .add_option_function<std::string>(
            orbis::server::flag_name(name), [&flags, name](const std::string& text) { flags.emplace_back(name, text); },
            std::string(setting.summary) + (fallback.empty() ? "" : " [" + fallback + "]") + " (" +
                orbis::server::environment_name(name) + ")")
        ->type_name(std::string(setting.value));
  }
}

Config configure(const std::string& file, const Flags& flags) {
  Config config;
  if (!file.empty()) orbis::server::apply_file(config, file);
  orbis::server::apply_environment(config, [](const std::string& name) -> std::optional<std::string> {
    const char* value = std::getenv(name.c_str());
    return value == nullptr ? std::nullopt : std::optional<std::string>(value);
  });
  for (const auto& [name, text] : flags) orbis::server::set(config, name, text);
  return config;
}

void add_options(CLI::App& command, Flags& options) {
  for (const auto& info : orbis::option_table()) {
    const std::string name(info.name);
    command
        .add_option_function<std::string>(
            orbis::server::flag_name(name),
            [&options, name](const std::string& text) { options.emplace_back(name, text); },
            std::string(info.summary) + " [" + std::string(info.fallback) + "]")
        ->type_name(std::string(info.values));
  }
}

int report(const orbis::Error& error) {
  const auto problem = orbis::api::make_problem(error);
  std::cerr << orbis::api::dump(orbis::api::to_json(problem), 2) << '\n';
  return problem.status < 500 ? 2 : 1;
}

struct CommandLine {
  std::string config_file;
  Flags settings;
  orbis::server::RunArguments run;
};

void describe_serve(CLI::App& app, CommandLine& line) {
  CLI::App* serve = app.add_subcommand("serve", "serve the HTTP API and the web page");
  serve->add_option("--config", line.config_file, "a JSON file of settings")->type_name("file");
  add_settings(*serve, line.settings);
}

// What `run` and `morph` have in common.
void describe_job(CLI::App& command, CommandLine& line) {
  command.add_option("-o,--out", line.run.output, "the textured GLB")->required()->type_name("OUT.glb");
  command.add_option("--report", line.run.report, "what was found, done and proved")->type_name("REPORT.json");
  command.add_option("--preview", line.run.preview, "the model and its spheres, to look at")->type_name("PREVIEW.png");
  command
      .add_option("--attach", line.run.attachments,
                  "a file that the model names or an image of a cube map; a directory stands for its files; without "
                  "this, the files that the model names are looked for beside it")
      ->type_name("FILE");
  command.add_option("--dump-stages", line.run.dump_stages, "write each stage as OBJ and PNG")->type_name("DIR");
  command.add_option("--save-maps", line.run.save_maps, "write each map that was baked")->type_name("DIR");
  add_options(command, line.run.options);
}

void describe_run(CLI::App& app, CommandLine& line) {
  CLI::App* run = app.add_subcommand("run", "process one file");
  run->add_option("input", line.run.input, "a model: GLB, glTF, Draco, OBJ, PLY, STL, or a zip of one with its files")
      ->required()
      ->type_name("IN");
  describe_job(*run, line);
}

void describe_morph(CLI::App& app, CommandLine& line) {
  CLI::App* morph = app.add_subcommand("morph", "one mesh that morphs from a model to another");
  morph->add_option("a", line.run.input, "the model to begin with")->required()->type_name("A");
  morph->add_option("b", line.run.second, "the model to become")->required()->type_name("B");
  describe_job(*morph, line);
}

int execute(const CLI::App& app, const CommandLine& line) {
  const Config config = configure(line.config_file, line.settings);
  if (app.got_subcommand("serve")) return orbis::server::serve(config);
  return orbis::server::run(line.run, config.scheduler.limits);
}

int parse_and_execute(int argc, char** argv) {
  CLI::App app("Maps closed genus-0 meshes to the sphere, and textures them.", "orbis");
  app.set_version_flag("--version", "orbis " ORBIS_VERSION);
  app.require_subcommand(1);
  CommandLine line;
  describe_serve(app, line);
  describe_run(app, line);
  describe_morph(app, line);
  try {
    app.parse(argc, argv);
    return execute(app, line);
  } catch (const CLI::ExtrasError& error) {
    return report(orbis::Error(orbis::ErrorCode::invalid_option, std::string(error.what()) + "; see orbis --help"));
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 1;
  } catch (const orbis::Error& error) {
    return report(error);
  }
}

} // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::string_view(argv[1]) == "job-child") orbis::server::run_job_child();
  try {
    return parse_and_execute(argc, argv);
  } catch (const std::exception& error) {
    std::fputs(error.what(), stderr); // no memory, no threads: nothing that could be reported better
    return 1;
  }
}
