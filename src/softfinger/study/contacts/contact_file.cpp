#include "softfinger/study/contacts/contact_file.hpp"

#include <fmt/core.h>
#include <hdf5.h>

#include <algorithm>
#include <map>
#include <optional>
#include <system_error>

#include "softfinger/base/error.hpp"
#include "softfinger/base/instruction_set.hpp"
#include "softfinger/base/unit_words.hpp"
#include "softfinger/base/units.hpp"
#include "softfinger/export/hdf5/column.hpp"
#include "softfinger/export/hdf5/handle.hpp"

namespace softfinger {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTitle = "Labelled contacts of a soft finger pad";
constexpr const char* kFrames =
    "F: right-handed, origin at the centre of the distal phalanx bone, x distal (out of the "
    "fingertip), y to the left seen from above the nail, z dorsal; the pad faces -z. nodes_mm and "
    "force_N (object on skin, normal and tangential together) are expressed in F. An object lies "
    "under F's origin: a plane, a sphere of radius_mm shifted by at_x_mm and at_y_mm, or a "
    "90-degree edge along y, solid at x <= 0, rounded by radius_mm; the finger, turned by "
    "pitch_deg "
    "about its y axis, distal end down, moves along -z of the world by indentation_mm beyond first "
    "touch. A press that does not come to rest, or misses, has converged = 0.";

Hdf5Handle file_access() {
  Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  hdf5_check(H5Pset_sieve_buf_size(access.id(), 0));  // what is written is in the file
  return access;
}

/// All of it has its place in the file at once, and nothing stands there.
Hdf5Handle make_set(hid_t where, const char* name, hid_t type, const std::vector<hsize_t>& size) {
  const Hdf5Handle space(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr),
                         H5Sclose);
  const Hdf5Handle creation = hdf5_creation(H5P_DATASET_CREATE);
  hdf5_check(H5Pset_alloc_time(creation.id(), H5D_ALLOC_TIME_EARLY));
  hdf5_check(H5Pset_fill_time(creation.id(), H5D_FILL_TIME_NEVER));
  Hdf5Handle set(H5Dcreate2(where, name, type, space.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT),
                 H5Dclose);
  const std::string_view unit = unit_symbol(name);
  hdf5_attribute(set.id(), "unit", std::string(unit.empty() ? "1" : unit));
  return set;
}

template <typename T>
void put_whole(hid_t where, const char* name, hid_t type, const std::vector<T>& values,
               hsize_t width) {
  std::vector<hsize_t> size{values.size() / width};
  if (width > 1) size.push_back(width);
  const Hdf5Handle set = make_set(where, name, type, size);
  hdf5_check(H5Dwrite(set.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
}

void put_mesh(hid_t file, const FingerModel& finger) {
  const Hdf5Handle group(
      H5Gcreate2(file, "mesh", H5P_DEFAULT, hdf5_creation(H5P_GROUP_CREATE).id(), H5P_DEFAULT),
      H5Gclose);
  std::vector<float> nodes;
  for (const Vector3& node : finger.mesh.nodes) {
    for (const double value : node) nodes.push_back(static_cast<float>(value / mm));
  }
  std::vector<int> tetrahedra;
  for (const auto& corners : finger.mesh.tetrahedra) {
    tetrahedra.insert(tetrahedra.end(), corners.begin(), corners.end());
  }
  std::vector<int> triangles;
  for (const auto& corners : finger.skin_triangles) {
    triangles.insert(triangles.end(), corners.begin(), corners.end());
  }
  put_whole(group.id(), "rest_nodes_mm", H5T_NATIVE_FLOAT, nodes, 3);
  put_whole(group.id(), "tetrahedra", H5T_NATIVE_INT, tetrahedra, 4);
  put_whole(group.id(), "skin_triangles", H5T_NATIVE_INT, triangles, 3);
  put_whole(group.id(), "sample_nodes", H5T_NATIVE_INT, finger.sample_nodes, 1);
}

std::string fact_name(const std::string& what) { return "from: " + what; }

std::string text_attribute(hid_t object, const char* name) {
  const Hdf5Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Hdf5Handle type(H5Aget_type(attribute.id()), H5Tclose);
  if (H5Tis_variable_str(type.id()) <= 0) throw Hdf5Failure{};
  char* words = nullptr;
  hdf5_check(H5Aread(attribute.id(), type.id(), static_cast<void*>(&words)));
  std::string text = words == nullptr ? "" : words;
  hdf5_check(H5free_memory(words));
  return text;
}

herr_t note_fact(hid_t object, const char* name, const H5A_info_t*, void* facts) {
  const std::string prefix = fact_name("");
  if (!std::string_view(name).starts_with(prefix)) return 0;
  try {
    (*static_cast<std::map<std::string, std::string>*>(facts))[name + prefix.size()] =
        text_attribute(object, name);
  } catch (const Hdf5Failure&) {
    return -1;
  }
  return 0;
}

}  // namespace

ContactsDone contacts_done(const fs::path& path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  try {
    const Hdf5Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    const Hdf5Handle set(H5Dopen2(file.id(), "done", H5P_DEFAULT), H5Dclose);
    const Hdf5Handle space(H5Dget_space(set.id()), H5Sclose);
    const hssize_t all = H5Sget_simple_extent_npoints(space.id());
    std::vector<std::uint8_t> done(all > 0 ? static_cast<std::size_t>(all) : 0);
    hdf5_check(H5Dread(set.id(), H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, done.data()));
    return {static_cast<std::size_t>(std::ranges::count(done, 1)), done.size()};
  } catch (const Hdf5Failure&) {
    throw InputError(fmt::format("{}: is damaged, or no file of contacts", path.string()));
  }
}

struct ContactFile::Implementation {
  /// A data set of a row a contact.
  struct Column {
    const char* name;
    hid_t type;
    std::vector<hsize_t> row;  ///< dimensions of a row; empty: one number
  };
  static std::vector<Column> columns_of(const FingerModel& finger) {
    const hsize_t nodes = finger.mesh.nodes.size();
    const hsize_t samples = finger.sample_nodes.size();
    const hid_t real = H5T_NATIVE_FLOAT;
    const hid_t truth = H5T_NATIVE_UINT8;
    return {{"press", H5T_NATIVE_UINT32, {}},
            {"person", H5T_NATIVE_UINT32, {}},
            {"length_factor", real, {}},
            {"breadth_factor", real, {}},
            {"depth_factor", real, {}},
            {"modulus_factor", real, {}},
            {"object", truth, {}},
            {"radius_mm", real, {}},
            {"at_x_mm", real, {}},
            {"at_y_mm", real, {}},
            {"pitch_deg", real, {}},
            {"friction_coefficient", real, {}},
            {"indentation_mm", real, {}},
            {"normal_force_N", real, {}},
            {"tangential_force_N", real, {}},
            {"contact_area_mm2", real, {}},
            {"converged", truth, {}},
            {"nodes_mm", real, {nodes, 3}},
            {"gap_mm", real, {samples}},
            {"pressure_kPa", real, {samples}},
            {"force_N", real, {samples, 3}},
            {"in_contact", truth, {samples}}};
  }

  fs::path path;
  const ContactStudy& study;
  const ContactPress& press;
  std::vector<Column> columns;
  std::optional<Hdf5Handle> file;
  std::vector<Hdf5Handle> sets;  ///< of the columns
  std::optional<Hdf5Handle> done_set;
  std::vector<std::uint8_t> done;  ///< by press

  void create(const std::vector<StudyFact>& facts) {
    const Hdf5Handle access = file_access();
    file.emplace(
        H5Fcreate(path.c_str(), H5F_ACC_EXCL, hdf5_creation(H5P_FILE_CREATE).id(), access.id()),
        H5Fclose);
    hdf5_attribute(file->id(), "title", kTitle);
    hdf5_attribute(file->id(), "frames", kFrames);
    hdf5_attribute(file->id(), "program", fmt::format("softfinger {}", SOFTFINGER_VERSION));
    hdf5_attribute(file->id(), "seed", static_cast<double>(study.seed));
    hdf5_attribute(file->id(), "study", study.text);
    hdf5_attribute(file->id(), "finger", study.finger.text.text());
    for (const StudyFact& fact : facts) {
      hdf5_attribute(file->id(), fact_name(fact.what), fact.value);
    }
    put_mesh(file->id(), press.nominal());
    for (const Column& column : columns) {
      std::vector<hsize_t> size{study.size};
      size.insert(size.end(), column.row.begin(), column.row.end());
      sets.push_back(make_set(file->id(), column.name, column.type, size));
    }
    std::string objects;
    for (const auto& row : kPressedOn)
      objects += fmt::format("{}{}", objects.empty() ? "" : ",", row.name);
    hdf5_attribute(sets[6].id(), "names", objects);
    done.assign(study.presses(), 0);
    done_set.emplace(make_set(file->id(), "done", H5T_NATIVE_UINT8, {done.size()}));
    hdf5_check(
        H5Dwrite(done_set->id(), H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, done.data()));
    // From here on only numbers change, each at its place.
    hdf5_check(H5Fflush(file->id(), H5F_SCOPE_GLOBAL));
  }

  void open(const std::vector<StudyFact>& facts) {
    const Hdf5Handle access = file_access();
    file.emplace(H5Fopen(path.c_str(), H5F_ACC_RDWR, access.id()), H5Fclose);
    std::map<std::string, std::string> then;
    hdf5_check(H5Aiterate2(file->id(), H5_INDEX_NAME, H5_ITER_INC, nullptr, note_fact, &then));
    refuse_other_facts(path, then, facts);
    for (const Column& column : columns) {
      sets.emplace_back(H5Dopen2(file->id(), column.name, H5P_DEFAULT), H5Dclose);
    }
    done_set.emplace(H5Dopen2(file->id(), "done", H5P_DEFAULT), H5Dclose);
    done.assign(study.presses(), 0);
    hdf5_check(
        H5Dread(done_set->id(), H5T_NATIVE_UINT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, done.data()));
  }

  /// Calls with a column's set, the rows of a press in it, and as many in memory.
  template <typename Call>
  void with_rows(std::size_t column, std::size_t number, const Call& call) {
    std::vector<hsize_t> begin{number * study.contacts_a_press};
    std::vector<hsize_t> count{study.contacts_a_press};
    for (const hsize_t size : columns[column].row) {
      begin.push_back(0);
      count.push_back(size);
    }
    const Hdf5Handle there(H5Dget_space(sets[column].id()), H5Sclose);
    hdf5_check(H5Sselect_hyperslab(there.id(), H5S_SELECT_SET, begin.data(), nullptr, count.data(),
                                   nullptr));
    const Hdf5Handle here(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr),
                          H5Sclose);
    hdf5_check(call(sets[column].id(), columns[column].type, here.id(), there.id()));
  }
  template <typename T>
  void write_column(std::size_t number, const char* name, const std::vector<T>& values) {
    const auto at = std::ranges::find(columns, std::string_view(name),
                                      [](const auto& each) { return std::string_view(each.name); });
    with_rows(static_cast<std::size_t>(at - columns.begin()), number,
              [&](hid_t set, hid_t type, hid_t here, hid_t there) {
                return H5Dwrite(set, type, here, there, H5P_DEFAULT, values.data());
              });
  }
  template <typename T>
  void read_column(std::size_t number, const char* name, std::vector<T>& values) {
    const auto at = std::ranges::find(columns, std::string_view(name),
                                      [](const auto& each) { return std::string_view(each.name); });
    std::size_t size = study.contacts_a_press;
    for (const hsize_t each : at->row) size *= each;
    values.resize(size);
    with_rows(static_cast<std::size_t>(at - columns.begin()), number,
              [&](hid_t set, hid_t type, hid_t here, hid_t there) {
                return H5Dread(set, type, here, there, H5P_DEFAULT, values.data());
              });
  }
  template <typename T>
  void write_same(std::size_t number, const char* name, T value) {
    write_column(number, name, std::vector<T>(study.contacts_a_press, value));
  }
};

ContactFile::ContactFile(const fs::path& file, const ContactStudy& study, const ContactPress& press,
                         const std::vector<StudyFact>& facts)
    : implementation_(new Implementation{.path = file,
                                         .study = study,
                                         .press = press,
                                         .columns = Implementation::columns_of(press.nominal())}) {
  // What fails is said here.
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  std::error_code error;
  const bool is_there = fs::exists(file, error);
  try {
    if (is_there) {
      implementation_->open(facts);
    } else {
      implementation_->create(facts);
    }
  } catch (const Hdf5Failure&) {
    if (!is_there) {
      throw OperationError(
          fmt::format("{}: cannot be written (is there room on the disk?)", file.string()));
    }
    throw InputError(
        fmt::format("{}: is damaged, or no file of contacts; move it away, and the "
                    "same command makes it anew",
                    file.string()));
  }
}

ContactFile::~ContactFile() = default;

bool ContactFile::has(std::size_t press) const { return implementation_->done[press] != 0; }

std::size_t ContactFile::done() const {
  return static_cast<std::size_t>(std::ranges::count(implementation_->done, 1));
}

void ContactFile::write(std::size_t number, const PressedContacts& contacts) {
  Implementation& self = *implementation_;
  const DrawnPress drawn = draw_press(self.study, number);
  const PersonFactors& person = self.press.person(drawn.person);
  const auto real = [](double value) { return static_cast<float>(value); };
  try {
    self.write_same(number, "press", static_cast<std::uint32_t>(number));
    self.write_same(number, "person", static_cast<std::uint32_t>(drawn.person));
    self.write_same(number, "length_factor", real(person.length));
    self.write_same(number, "breadth_factor", real(person.breadth));
    self.write_same(number, "depth_factor", real(person.depth));
    self.write_same(number, "modulus_factor", real(person.modulus));
    self.write_same(number, "object", static_cast<std::uint8_t>(drawn.shape));
    self.write_same(number, "radius_mm", real(drawn.radius / mm));
    self.write_same(number, "at_x_mm", real(drawn.at_x / mm));
    self.write_same(number, "at_y_mm", real(drawn.at_y / mm));
    self.write_same(number, "pitch_deg", real(drawn.pitch / deg));
    self.write_same(number, "friction_coefficient", real(drawn.friction));
    self.write_column(number, "indentation_mm", contacts.indentation_mm);
    self.write_column(number, "normal_force_N", contacts.normal_force_N);
    self.write_column(number, "tangential_force_N", contacts.tangential_force_N);
    self.write_column(number, "contact_area_mm2", contacts.contact_area_mm2);
    self.write_column(number, "converged", contacts.converged);
    self.write_column(number, "nodes_mm", contacts.nodes_mm);
    self.write_column(number, "gap_mm", contacts.gap_mm);
    self.write_column(number, "pressure_kPa", contacts.pressure_kPa);
    self.write_column(number, "force_N", contacts.force_N);
    self.write_column(number, "in_contact", contacts.in_contact);
    // Last: until then it is not there.
    const hsize_t begin = number;
    const hsize_t one = 1;
    const Hdf5Handle there(H5Dget_space(self.done_set->id()), H5Sclose);
    hdf5_check(H5Sselect_hyperslab(there.id(), H5S_SELECT_SET, &begin, nullptr, &one, nullptr));
    const Hdf5Handle here(H5Screate_simple(1, &one, nullptr), H5Sclose);
    self.done[number] = 1;
    hdf5_check(H5Dwrite(self.done_set->id(), H5T_NATIVE_UINT8, here.id(), there.id(), H5P_DEFAULT,
                        &self.done[number]));
  } catch (const Hdf5Failure&) {
    throw OperationError(fmt::format(
        "{}: cannot be written (is there room on the disk?); what is written stays, and the same "
        "command goes on from there",
        self.path.string()));
  }
}

PressedContacts ContactFile::read(std::size_t number) {
  Implementation& self = *implementation_;
  PressedContacts contacts;
  try {
    self.read_column(number, "indentation_mm", contacts.indentation_mm);
    self.read_column(number, "normal_force_N", contacts.normal_force_N);
    self.read_column(number, "tangential_force_N", contacts.tangential_force_N);
    self.read_column(number, "contact_area_mm2", contacts.contact_area_mm2);
    self.read_column(number, "converged", contacts.converged);
    self.read_column(number, "nodes_mm", contacts.nodes_mm);
    self.read_column(number, "gap_mm", contacts.gap_mm);
    self.read_column(number, "pressure_kPa", contacts.pressure_kPa);
    self.read_column(number, "force_N", contacts.force_N);
    self.read_column(number, "in_contact", contacts.in_contact);
  } catch (const Hdf5Failure&) {
    throw OperationError(fmt::format("{}: cannot be read", self.path.string()));
  }
  return contacts;
}

void ContactFile::close() {
  Implementation& self = *implementation_;
  self.sets.clear();
  self.done_set.reset();
  try {
    self.file->close();
  } catch (const Hdf5Failure&) {
    throw OperationError(
        fmt::format("{}: cannot be written (is there room on the disk?)", self.path.string()));
  }
}

}  // namespace softfinger
