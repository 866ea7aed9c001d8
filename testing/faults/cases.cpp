#include "testing/faults/cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <string_view>

#include "robomill/base/random.hpp"
#include "testing/jobs/lobes_file.hpp"
#include "testing/processes.hpp"

namespace robomill::faults {
namespace {

std::string one_mode() {
  std::string text = "frequency_hz,xx_re_m_per_n,xx_im_m_per_n\n";
  for (int f = 300; f <= 900; f += 4) {
    const double ratio = f / 600.0;
    const std::complex<double> h = 1e-7 / std::complex<double>(1.0 - ratio * ratio, 0.06 * ratio);
    text += fmt::format("{},{},{}\n", f, h.real(), h.imag());
  }
  return text;
}

std::string lobes_toml() {
  return test_support::lobes_file(
      "spindle_speed_rpm = [6000, 9000]\naxial_depth_mm = [0, 3]\ngrid = [6, 4]\n[dynamics]\n"
      "x = [{ frequency_hz = 620, damping_ratio = 0.03, modal_mass_kg = 0.6 }]\n"
      "y = [{ frequency_hz = 660, damping_ratio = 0.03, modal_mass_kg = 0.6 }]\n");
}

constexpr const char* modes_toml = R"([[modes]]
frequency_hz = 620
damping_ratio = 0.03
left = { x = [0.01, 0.0], y = [0.0, 0.0] }
right = { x = [0.0, -0.01], y = [0.0, 0.0] }
[[modes]]
frequency_hz = 660
damping_ratio = 0.03
left = { x = [0.0, 0.0], y = [0.01, 0.0] }
right = { x = [0.0, 0.0], y = [0.0, -0.01] }
)";

std::string bar(int length_mm) {
  return fmt::format(
      "length_mm = {}\ndiameter_mm = 12\nyoungs_modulus_gpa = 200\ndensity_kg_per_m3 = 7800\nloss_factor = 0.02\n",
      length_mm);
}

std::string assembly_toml() {
  return "[frequency]\nrange_hz = [10, 2000]\nstep_hz = 20\n[[tool]]\n" + bar(118) +
         "[joint]\ntranslational_stiffness_n_per_m = 6e7\ntranslational_damping_n_s_per_m = 60\n"
         "rotational_stiffness_n_m_per_rad = 2.5e4\nrotational_damping_n_m_s_per_rad = 0.15\n"
         "[holder]\n[[holder.segments]]\n" +
         bar(50);
}

/// An arm with limits and what a motion needs.
constexpr const char* cell_toml = R"([robot]
model = "kuka-kr210-r2700"
[workpiece]
origin_mm = [1800, 0, 700]
[tool]
length_mm = 350
[program]
machine = "xyzac-trt"
[smoothing]
tip_tolerance_mm = 0.02
axis_tolerance_deg = 0.1
max_velocity_mm_per_s = 50
max_acceleration_mm_per_s2 = 500
max_jerk_mm_per_s3 = 10000
max_angular_velocity_deg_per_s = 60
max_angular_acceleration_deg_per_s2 = 600
max_angular_jerk_deg_per_s3 = 12000
)";

constexpr const char* part_ngc = "G21 G90 G94\nG64\nG0 X0 Y0 Z40 A-20 C0\nG1 X4 F1800\nG1 X4 Y3 A-22\nM30\n";

/// An arm of no maker: programs of every controller are written for it.
std::string smoothing_cell() {
  return test::slurp(ROBOMILL_SOURCE_DIR "/examples/smooth-impeller-like/cell.toml");
}

/// Two links on springs, measured in one posture.
constexpr const char* measured_cell = R"([robot]
dh = [{ a_mm = 600, alpha_deg = 90 }, { a_mm = 400, alpha_deg = 90 }]
joint_stiffness_n_m_per_rad = [4e5, 3e5]
joint_damping_n_m_s_per_rad = [60, 40]
links = [{ mass_kg = 40, inertia_kg_m2 = [1, 2, 2, 0, 0, 0] }, { mass_kg = 20, inertia_kg_m2 = [0.5, 1, 1, 0, 0, 0] }]
[tool]
length_mm = 150
[[postures]]
joints_deg = [0, 20]
frf = "arm.csv"
)";

std::string arm_csv() {
  std::string text = "frequency_hz,xx_re_m_per_n,xx_im_m_per_n,yy_re_m_per_n,yy_im_m_per_n\n";
  for (int f = 5; f <= 125; f += 5) {
    text += fmt::format("{}", f);
    for (const double mode_hz : {18.0, 24.0}) {
      const double ratio = f / mode_hz;
      const std::complex<double> h = 2e-6 / std::complex<double>(1.0 - ratio * ratio, 0.08 * ratio);
      text += fmt::format(",{},{}", h.real(), h.imag());
    }
    text += "\n";
  }
  return text;
}

/// A slot of two blocks in a box.
constexpr const char* slot_ngc = "G21 G90 G94\nS9000 M3\nG0 X-8 Y0 Z5\nG1 Z-1 F600\nG1 X0\nG1 X8\nG0 Z5\nM30\n";
constexpr const char* slot_toml = R"([tool]
kind = "flat-end"
teeth = 2
diameter_mm = 6
helix_deg = 30
[coefficients]
tangential_n_per_mm2 = 900
radial_n_per_mm2 = 350
axial_n_per_mm2 = 150
[stock]
kind = "box"
min_mm = [-10, -5, -4]
max_mm = [10, 5, 0]
dexel_mm = 0.5
)";

/// A cut at 3000 rpm with two teeth, in which chatter grows from 2 s on.
std::string cut_csv() {
  constexpr double rate_hz = 5120.0, onset_s = 2.0;
  Random random(1);
  std::string text = "time_s,ax_m_per_s2\n";
  for (int i = 0; i < static_cast<int>(3.0 * rate_hz); ++i) {
    const double t = i / rate_hz;
    double x = 0.3 * random.normal();
    for (int k = 1; k <= 6; ++k) x += 4.0 / k * std::sin(2.0 * std::numbers::pi * 50.0 * k * t + k);
    if (t > onset_s) {
      x += std::min(20.0, 0.02 * std::exp((t - onset_s) / 0.05)) * std::sin(2.0 * std::numbers::pi * 683.0 * t);
    }
    text += fmt::format("{:.9f},{:.5g}\n", t, x);
  }
  return text;
}

constexpr const char* wav_monitor_toml = "[signal]\nchannels = [1]\n[process]\nspindle_speed_rpm = 7000\nteeth = 3\n";

/// Noise that trebles where chatter begins.
Files labelled_recordings() {
  constexpr int frames = 12'000;
  Files files;
  std::string text = "[signal]\nchannels = [1]\nsample_rate_hz = 10240\n[calibration]\nfalse_alarm_rate = 0.1\n";
  Random random(3);
  for (int i = 0; i < 8; ++i) {
    const bool chatters = i % 2 == 1;
    std::string rows;
    for (int k = 0; k < frames; ++k) {
      rows += fmt::format("{:.4g}\n", (chatters && k > frames / 2 ? 3.0 : 1.0) * random.normal());
    }
    const std::string name = fmt::format("rec{}.csv", i);
    files[name] = rows;
    text += fmt::format("[[recordings]]\nfile = \"{}\"\nlabel = \"{}\"\n", name, chatters ? "chatter" : "stable");
    if (chatters) text += fmt::format("onset_s = {}\n", frames / 2 / 10240.0);
  }
  files["recordings.toml"] = text;
  return files;
}

constexpr const char* force_cut_toml =
    "force_on = \"tool\"\n[tool]\nkind = \"flat-end\"\ndiameter_mm = 10\nteeth = 2\nhelix_deg = "
    "30\n[cut]\naxial_depth_mm = "
    "2\nradial_depth_mm = 5\nfeed_per_tooth_mm = 0.1\ndirection = \"up\"\nspindle_speed_rpm = 6000\n[coefficients]\n"
    "tangential_n_per_mm2 = 800\nradial_n_per_mm2 = 300\n";

/// Forces that repeat with the teeth of such a cut.
std::string force_record() {
  std::string text = "time_s,fx_n,fy_n,fz_n\n";
  for (int i = 0; i < 1000; ++i) {
    const double t = 2e-4 * i, angle = 2.0 * std::numbers::pi * 200.0 * t;
    text += fmt::format("{:.4f},{:.4g},{:.4g},{:.4g}\n", t, 40.0 + 60.0 * std::cos(angle),
                        30.0 + 50.0 * std::sin(angle), 5.0 + 3.0 * std::cos(angle + 1.0));
  }
  return text;
}

Files inputs_of_verb(std::string_view verb) {
  if (verb == "init" || verb == "frf") return {};
  if (verb == "modes") return {{"tip.csv", one_mode()}, {"assembly.toml", assembly_toml()}};
  if (verb == "modes --cell") return {{"cell.toml", measured_cell}, {"arm.csv", arm_csv()}};
  if (verb == "couple") return {{"assembly.toml", assembly_toml()}};
  if (verb == "couple --tools") {
    return {{"assembly.toml", assembly_toml()}, {"tools.csv", "tool,length_mm,diameter_mm\nbar,118,12\nshort,80,12\n"}};
  }
  if (verb == "joint") return {{"assembly.toml", assembly_toml()}};
  if (verb == "lobes" || verb == "simulate") return {{"lobes.toml", lobes_toml()}};
  if (verb == "explain") {
    return {{"modes.toml", modes_toml}};
  }
  if (verb == "forces") return {};
  if (verb == "forces --program") return {{"slot.ngc", slot_ngc}, {"slot.toml", slot_toml}, {"cell.toml", cell_toml}};
  if (verb == "coefficients") {
    return {{"slots.csv",
             "feed_per_tooth_mm,axial_depth_mm,spindle_speed_rpm,fx_n,fy_n,fz_n\n0.05,5.08,3000,-555.8508,655.6513,"
             "255.9891\n0.1,5.08,3000,-751.4308,1119.2013,493.6902\n0.025,5.08,3000,-458.0608,423.8763,137.1385\n"}};
  }
  if (verb == "coefficients --signal") return {{"cut.toml", force_cut_toml}, {"record.csv", force_record()}};
  if (verb == "forces --measured") return {{"cut.toml", force_cut_toml}, {"record.csv", force_record()}};
  if (verb == "stiffness") {
    return {{"cell.toml", "[robot]\ndh = [{ a_mm = 800 }, { a_mm = 200, alpha_deg = 90 }]\n"},
            {"loads.csv",
             "q1_deg,q2_deg,fx_n,fy_n,fz_n,dx_mm,dy_mm,dz_mm\n0,90,100,0,0,0.044,-0.016,0\n0,0,0,100,0,0,0.14,0\n"
             "0,90,0,100,0,-0.016,0.064,0\n"}};
  }
  if (verb == "cell check") return {{"cell.toml", cell_toml}, {"slot.ngc", slot_ngc}};
  if (verb == "monitor a wav") return {{"lobes.toml", lobes_toml()}, {"monitor.toml", wav_monitor_toml}};
  if (verb == "smooth") return {{"cell.toml", smoothing_cell()}, {"part.ngc", part_ngc}};
  if (verb == "monitor") {
    return {{"monitor.toml",
             "[signal]\nchannels = [\"ax_m_per_s2\"]\nsample_rate_hz = 5120\n[process]\nspindle_speed_rpm = "
             "3000\nteeth = 2\n"},
            {"cut.csv", cut_csv()}};
  }
  if (verb == "calibrate") return labelled_recordings();
  if (verb == "plan a program") {
    return {{"slot.ngc", slot_ngc},
            {"slot.toml", slot_toml},
            {"modes.toml", modes_toml},
            {"cell.toml", smoothing_cell()},
            {"job.toml",
             "[job]\nforces = \"slot.toml\"\ncell = \"cell.toml\"\nprogram = \"slot.ngc\"\nmodes = \"modes.toml\"\n"
             "[spindle]\nmin_speed_rpm = 6000\nmax_speed_rpm = 12000\n[decide]\nfree = [\"spindle_speed\"]\n"}};
  }
  if (verb == "sweep") {
    return {{"lobes.toml", lobes_toml()},
            {"study.toml",
             "[study]\njob = \"lobes\"\nbase = \"lobes.toml\"\ncollect = \"limit@7000\"\nchunk_points = 2\n"
             "[[vary]]\nkey = \"cut.radial_depth_mm\"\nvalues = [1, 2, 3]\n"}};
  }
  if (verb == "sweep a boundary") {
    return {{"lobes.toml", lobes_toml()},
            {"study.toml",
             "[study]\njob = \"lobes\"\nbase = \"lobes.toml\"\nchunk_points = 2\n"
             "[boundary]\nvalue = \"abs_mu@7000,0.5\"\nlevel = 0.75\nhalvings = 2\n"
             "[[vary]]\nkey = \"cut.radial_depth_mm\"\nrange = [0.5, 8]\ncount = 3\n"}};
  }
  if (verb == "plan") {
    return {{"lobes.toml", lobes_toml()},
            {"modes.toml", modes_toml},
            {"job.toml",
             "[job]\nmodes = \"modes.toml\"\nlobes = \"lobes.toml\"\n[spindle]\nmin_speed_rpm = 6000\n"
             "max_speed_rpm = 9000\n[tool]\nmax_axial_depth_mm = 3\n"}};
  }
  throw std::runtime_error("no inputs of " + std::string(verb));
}

constexpr const char* hits = "init hits --example --quiet";
constexpr const char* tip = "couple assembly.toml -o tip.uff --quiet";
constexpr const char* posture = "modes --cell cell.toml --joints 5,30 -o modes.json";
constexpr const char* other_posture = "modes --cell cell.toml --joints 5,40 -o other.json --quiet";
constexpr const char* example_forces = "init forces --example --quiet";

}  // namespace

std::vector<Case> all_cases() {
  return {
      {"init", "job", "init job --example --quiet", "", is_new | together},
      {"init", "standard output", "init lobes --example -o - --quiet", "", to_stdout},
      {"frf", "uff", "frf hits.toml -o tip.uff", hits},
      {"frf", "binary uff", "frf hits.toml --binary -o tip.uff", hits},
      {"frf", "csv", "frf hits.toml -o tip.csv", hits},
      {"frf", "txt", "frf hits.toml -o tip.txt", hits},
      {"frf", "mat", "frf hits.toml -o tip.mat", hits},
      {"frf", "json", "frf hits.toml -o tip.json", hits},
      {"frf", "standard output", "frf hits.toml -o -", hits, to_stdout},
      {"modes", "json", "modes tip.csv -o modes.json"},
      {"modes", "csv", "modes tip.csv -o modes.csv"},
      {"modes", "report html", "modes tip.csv -o modes.json --report modes.html"},
      {"modes", "json from mat", "modes tip.mat --modes 2 --band 100,1500 -o modes.json",
       "couple assembly.toml -o tip.mat --quiet"},
      {"modes", "json from uff", "modes tip.uff --modes 2 --band 100,1500 -o modes.json", tip},
      {"modes --cell", "json and a kept calibration", posture, "", is_new | goes_on},
      {"modes --cell", "json from a kept calibration", posture, other_posture, goes_on},
      {"couple", "uff", "couple assembly.toml -o c.uff"},
      {"couple", "mat", "couple assembly.toml -o c.mat"},
      {"couple", "json", "couple assembly.toml -o c.json"},
      {"couple --tools", "csv and FRFs", "couple assembly.toml --tools tools.csv -o table.csv --frfs tips"},
      {"joint", "json", "joint assembly.toml --measured tip.uff -o joint.json", tip},
      {"joint", "csv", "joint assembly.toml --measured tip.uff -o joint.csv", tip},
      {"lobes", "json", "lobes lobes.toml -o lobes.json"},
      {"lobes", "csv", "lobes lobes.toml -o lobes.csv"},
      {"lobes", "report html", "lobes lobes.toml -o lobes.json --report lobes.html"},
      {"lobes", "report json", "lobes lobes.toml --report report.json"},
      {"lobes", "standard output", "lobes lobes.toml -o -", "", to_stdout},
      {"lobes", "summary", "lobes lobes.toml", "", to_stdout},
      {"simulate", "csv", "simulate lobes.toml --at 7000,0.5 --seconds 0.1 -o s.csv"},
      {"simulate", "json", "simulate lobes.toml --at 7000,0.5 --seconds 0.1 -o s.json"},
      {"simulate", "wav", "simulate lobes.toml --at 7000,0.5 --seconds 0.1 -o s.wav"},
      {"simulate", "mat", "simulate lobes.toml --at 7000,0.5 --seconds 0.1 -o s.mat"},
      {"explain", "json", "explain --peaks 325,667 --rpm 6500 --teeth 3 --modes modes.toml -o peaks.json"},
      {"explain", "csv", "explain --peaks 325,667 --rpm 6500 --teeth 3 --modes modes.toml -o peaks.csv"},
      {"forces", "csv", "forces forces.toml -o f.csv", example_forces},
      {"forces", "json", "forces forces.toml -o f.json", example_forces},
      {"forces --program", "csv", "forces slot.toml --program slot.ngc --cell cell.toml -o f.csv"},
      {"coefficients", "toml", "coefficients slots.csv -o c.toml"},
      {"coefficients", "csv", "coefficients slots.csv -o c.csv"},
      {"coefficients", "json", "coefficients slots.csv -o c.json"},
      {"coefficients --signal", "toml", "coefficients --signal record.csv --cut cut.toml -o c.toml"},
      {"coefficients --signal", "json", "coefficients --signal record.csv --cut cut.toml -o c.json"},
      {"forces --measured", "csv", "forces cut.toml --measured record.csv -o f.csv"},
      {"stiffness", "toml", "stiffness loads.csv --cell cell.toml -o s.toml"},
      {"stiffness", "csv", "stiffness loads.csv --cell cell.toml -o s.csv"},
      {"stiffness", "json", "stiffness loads.csv --cell cell.toml -o s.json"},
      {"cell check", "json", "cell check cell.toml -o check.json"},
      {"cell check", "report html", "cell check cell.toml --report check.html"},
      {"cell check", "json of a program", "cell check cell.toml --program slot.ngc -o check.json"},
      {"smooth", "csv", "smooth part.ngc --cell cell.toml -o t.csv"},
      {"smooth", "h5", "smooth part.ngc --cell cell.toml -o t.h5", "", hdf5},
      {"smooth", "src", "smooth part.ngc --cell cell.toml -o t.src"},
      {"smooth", "mod", "smooth part.ngc --cell cell.toml -o t.mod"},
      {"smooth", "script", "smooth part.ngc --cell cell.toml -o t.script"},
      {"smooth", "servoj", "smooth part.ngc --cell cell.toml -o t.servoj"},
      {"smooth", "csv and report html", "smooth part.ngc --cell cell.toml -o t.csv --report smooth.html"},
      {"monitor", "jsonl", "monitor monitor.toml --input cut.csv -o events.jsonl", "", goes_on},
      {"monitor", "recordings wav", "monitor monitor.toml --input cut.csv --record alarms", "", is_new | goes_on},
      {"monitor", "report json", "monitor monitor.toml --input cut.csv --report report.json", "", goes_on},
      {"monitor", "standard output", "monitor monitor.toml --input cut.csv -o -", "", to_stdout | goes_on},
      {"monitor a wav", "jsonl", "monitor monitor.toml --input cut.wav --every-window -o events.jsonl",
       "simulate lobes.toml --at 7000,0.5 --seconds 1 -o cut.wav --quiet", goes_on},
      {"calibrate", "toml and report json", "calibrate recordings.toml -o calibrated.toml --report report.json"},
      {"sweep", "folder", "sweep study.toml -o study", "", is_new | hdf5},
      {"sweep a boundary", "folder", "sweep study.toml -o study", "", is_new | hdf5},
      {"plan", "folder", "plan job.toml -o plan", "", together},
      {"plan", "new folder", "plan job.toml -o plan", "", is_new | together},
      {"plan a program", "folder", "plan job.toml -o plan", "", together},
      {"plan", "report html", "plan job.toml --report plan.html"},
      {"plan", "standard output", "plan job.toml -o -", "", to_stdout},
  };
}

Files inputs_of(const Case& which) {
  return inputs_of_verb(which.verb);
}

}  // namespace robomill::faults
