#include "archive/http_lines.h"

#include <netdb.h>
#include <openssl/ssl.h>
#include <openssl/x509_vfy.h>

namespace clipgs {

namespace {

std::string seconds_of(std::chrono::milliseconds time) {
  return fmt::format("{:.3g} s", std::chrono::duration<double>(time).count());
}

/// Why a certificate is not taken, and what to do.
std::string certificate_line(long verification) {
  switch (verification) {
    case X509_V_ERR_CERT_HAS_EXPIRED:
      return "the time of its certificate is over; ask those who run it to renew it";
    case X509_V_ERR_CERT_NOT_YET_VALID:
      return "its certificate is not good yet; is this machine's clock right?";
    case X509_V_OK:  // OpenSSL takes it, httplib does not find the host in it
    case X509_V_ERR_HOSTNAME_MISMATCH:
    case X509_V_ERR_IP_ADDRESS_MISMATCH:
      return "its certificate is for another host; give the name that the certificate has";
    case X509_V_ERR_DEPTH_ZERO_SELF_SIGNED_CERT:
    case X509_V_ERR_SELF_SIGNED_CERT_IN_CHAIN:
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT:
    case X509_V_ERR_UNABLE_TO_GET_ISSUER_CERT_LOCALLY:
    case X509_V_ERR_UNABLE_TO_VERIFY_LEAF_SIGNATURE:
      return "its certificate is not trusted; give the certificate of its authority with --ca-file";
    default:
      return fmt::format("its certificate is not trusted ({}); ask those who run it",
                         X509_verify_cert_error_string(verification));
  }
}

/// What the other end says of the certificate that it was shown, or not; "": nothing.
std::string alert_line(int alert, bool has_certificate) {
  switch (alert) {
    case SSL3_AD_HANDSHAKE_FAILURE:
    case SSL3_AD_BAD_CERTIFICATE:
    case SSL3_AD_CERTIFICATE_EXPIRED:
    case SSL3_AD_CERTIFICATE_REVOKED:
    case SSL3_AD_CERTIFICATE_UNKNOWN:
    case TLS1_AD_UNKNOWN_CA:
    case TLS1_AD_ACCESS_DENIED:
    case TLS13_AD_CERTIFICATE_REQUIRED:
      return has_certificate
                 ? "refuses the certificate of --client-certificate; give one that it knows"
                 : "wants a certificate of who asks; give --client-certificate and --client-key";
    default:
      return "";
  }
}

std::string connection_line(const HttpOutcome& outcome, const Url& url,
                            const HttpOptions& options) {
  std::string alert = alert_line(outcome.alert, !options.certificate.empty());
  if (!alert.empty()) {
    return alert;
  }
  const char* const proxy = outcome.through_proxy ? ", or the proxy that leads there" : "";
  switch (outcome.failure) {
    case HttpFailure::kUnreachable:
      return outcome.through_proxy
                 ? "the proxy that leads there cannot be reached; check https_proxy"
             : is_unknown_host(url.host) ? "there is no host of that name; check the address"
                                         : "nobody answers there; check the address, its port, and "
                                           "whether the archive runs";
    case HttpFailure::kConnectTimeout:
      return fmt::format("cannot be reached within {}; check the address and the network{}",
                         seconds_of(options.connect_limit), proxy);
    case HttpFailure::kTls:
      return fmt::format("speaks no TLS that this program knows; is it http, not https{}?", proxy);
    case HttpFailure::kAuthorities:
      return fmt::format("{} holds no certificates of authorities; give a PEM file",
                         options.authorities.string());
    case HttpFailure::kCertificate:
      return certificate_line(outcome.verification);
    default:
      return outcome.timed_out
                 ? fmt::format("does not go on within {}; try again later",
                               seconds_of(options.idle_limit))
                 : "the connection was cut; try again, and look whether the archive still runs";
  }
}

std::string status_line(int status, const HttpOptions& options) {
  const bool anonymous = options.token.empty() && options.user.empty();
  switch (status) {
    case 401:
      return anonymous ? "wants to know who asks (401); give --token-file, or --user"
                       : "does not take this token or password (401); get a new one";
    case 403:
      return "does not let you have that (403); ask those who run it for the right to";
    case 404:
      return "has nothing there (404); check the address, and the study's and series' UID";
    case 406:
      return "does not hand it out in this form (406); is it a DICOMweb archive?";
    case 407:
      return "the proxy wants to know who asks (407); give https_proxy a user and a password";
    case 429:
      return "is asked too often (429); try again later";
    default:
      return status >= 500
                 ? fmt::format("cannot do that now ({}); try again, and look at its log", status)
                 : fmt::format("answers {}, which is no success; check the address", status);
  }
}

}  // namespace

bool is_unknown_host(const std::string& host) {
  addrinfo* found = nullptr;
  const int error = ::getaddrinfo(host.c_str(), nullptr, nullptr, &found);
  if (error == 0) {
    ::freeaddrinfo(found);
  }
  return error == EAI_NONAME;
}

std::string line_of(const HttpOutcome& outcome, const Url& url, const HttpOptions& options) {
  const bool has_status = outcome.status != 0 && outcome.status / 100 != 2;
  return has_status ? status_line(outcome.status, options) : connection_line(outcome, url, options);
}

}  // namespace clipgs
