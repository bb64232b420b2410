#include "services/runtime/cli.hpp"

#include <cmath>
#include <cstdio>
#include <exception>
#include <utility>

#include "services/runtime/error.hpp"

namespace gyrotwin {

namespace {

void complain(const CLI::App& app, const std::string& what) {
  std::fprintf(stderr, "%s: error: %s\n", app.get_name().c_str(), what.c_str());
}

}  // namespace

RigOptions::RigOptions(CLI::App& app) {
  app.fallthrough();  // subcommands inherit it
  app.add_option("--rig", rig_, "Rig file, or the name of a shipped rig")
      ->envname("GYROTWIN_RIG")
      ->type_name("NAME|FILE")
      ->capture_default_str()
      ->group("Rig");
  app.add_option("--set", overrides_,
                 "Override a key of the rig file, e.g. loop.rate_hz=500; repeatable")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false)
      ->group("Rig");
  app.add_flag("--check-config", check_, "Only check the rig file")->group("Rig");
  app.add_flag("--print-config", print_, "Only print the rig with its defaults and overrides")
      ->group("Rig");
}

void RigOptions::override_key(std::string key_and_value) {
  overrides_.push_back(std::move(key_and_value));
}

Rig RigOptions::load() const {
  Rig rig = load_rig(rig_, overrides_);
  if (print_) std::fputs(print_rig(rig_, overrides_).c_str(), stdout);
  if (check_) std::printf("%s: ok\n", rig.file.c_str());
  // As CLI11 does it for --help and --version.
  if (print_ || check_) throw CLI::Success();
  return rig;
}

CLI::Validator finite_within(double low, double high) {
  const auto plain = [](double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", x);
    return std::string(text);
  };
  const std::string range = plain(low) + " to " + plain(high);
  return CLI::Validator(
      [=](std::string& text) {
        double x = 0.0;
        const bool right =
            CLI::detail::lexical_cast(text, x) && std::isfinite(x) && x >= low && x <= high;
        return right ? std::string() : '`' + text + "` is no number from " + range;
      },
      "in " + range);
}

int run_program(int argc, char** argv, CLI::App& app, const std::function<int()>& body) {
  app.set_version_flag("--version", app.get_name() + " " GYROTWIN_VERSION);
  try {
    app.parse(argc, argv);
    return body();
  } catch (const CLI::Success& answered) {
    return app.exit(answered);  // prints help or version
  } catch (const CLI::ParseError& error) {
    complain(app, std::string(error.what()) + "\n`" + app.get_name() +
                      " --help` shows what can be given");
    return kUsage;
  } catch (const Error& error) {
    complain(app, error.what());
    return kUsage;
  } catch (const std::exception& error) {
    complain(app, error.what());
    return kNotDone;
  }
}

}  // namespace gyrotwin
