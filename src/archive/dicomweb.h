#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "archive/http_client.h"
#include "archive/multipart.h"

namespace clipgs {

/// What is asked of an archive: "dicomweb+https://HOST[:PORT]/PREFIX/studies/UID[/series/UID]".
struct DicomWebAddress {
  std::string base;    ///< "https://HOST[:PORT]/PREFIX"
  std::string study;   ///< UID
  std::string series;  ///< UID; "": not said
};

/// Whether it begins as such an address does.
bool is_dicomweb(std::string_view text);

/// Throws Error, which does not repeat the text.
DicomWebAddress parse_dicomweb(std::string_view text);

/// A series of a study, as an archive lists it.
struct ArchiveSeries {
  std::string uid;
  std::string modality;  ///< "CT", "MR", …
  int number = 0;        ///< DICOM's series number
  int images = 0;        ///< its instances
  bool taken = false;

  /// False for reports, presentation states, segmentations, radiotherapy's plans and the like.
  bool shows_pictures() const;
  /// "CT, series 3, 120 images".
  std::string describe() const;
};

/// A study in an archive that speaks DICOMweb (PS3.18): what is in it (QIDO-RS), and the files
/// (WADO-RS). Throws HttpError, and Error where the archive answers something else.
class DicomWebStudy {
 public:
  /// `client`: its base is DicomWebAddress::base. It must outlive the object.
  DicomWebStudy(HttpClient& client, std::string study);

  /// The largest first; those that show no pictures after all others. The number of instances is
  /// asked for where the list has none.
  std::vector<ArchiveSeries> series();
  /// How many instances the archive says that it has of the series; 0: it does not say.
  int count(const std::string& series);
  /// The UIDs of its instances, in their order.
  std::vector<std::string> instances(const std::string& series);

  /// The files of a series, each as it is stored, one part each. Where the archive does not go on
  /// an HttpError with status 0 ends it, after the parts that were whole.
  void retrieve(const std::string& series, const PartReceiver& receiver);
  /// One of them.
  void retrieve(const std::string& series, const std::string& instance,
                const PartReceiver& receiver);

  std::string place() const { return client_.place(); }
  const std::string& path() const { return path_; }  ///< "/studies/UID"

 private:
  std::vector<ArchiveSeries> list(const std::string& query);
  void retrieve_from(const std::string& path, const PartReceiver& receiver);

  HttpClient& client_;
  std::string path_;
};

/// The index of the series with this number in the list (from 1), or UID; empty: the first, with a
/// warning that lists the others. Throws Error if there is none, or none with pictures.
size_t choose_series(const std::vector<ArchiveSeries>& list, const std::string& wanted,
                     const std::string& where);

/// Whether it is a UID (PS3.5, 9.1), and nothing else can be in it.
bool is_uid(std::string_view text);

}  // namespace clipgs
